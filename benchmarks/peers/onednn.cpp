#include "../support/described_network.hpp"
#include "peer.hpp"

#include <algorithm>
#include <dnnl.hpp>
#include <omp.h>
#include <unordered_map>

namespace benchmark {

namespace {

using tag = dnnl::memory::format_tag;
using dims = dnnl::memory::dims;
constexpr auto f32 = dnnl::memory::data_type::f32;

dnnl::memory::dim number(std::size_t value) {
    return static_cast<dnnl::memory::dim>(value);
}

class onednn final : public peer {
public:
    onednn(const described_network& network, std::size_t batch, std::size_t threads)
        : engine_(dnnl::engine::kind::cpu, 0), stream_(engine_) {
        omp_set_num_threads(static_cast<int>(threads));
        maps_.resize(network.maps().size());
        const tactnet::shape in = network.maps().front();
        maps_[0] = dnnl::memory(
            {{number(batch), number(in.channels), number(in.rows), number(in.columns)}, f32, tag::nchw},
            engine_);
        for (const operation& o : network.operations())
            switch (o.what) {
            case operation::kind::convolution:
                add_convolution(o, batch);
                break;
            case operation::kind::pool:
                add_pool(o, batch, dnnl::algorithm::pooling_max);
                break;
            case operation::kind::average:
                add_pool(o, batch, dnnl::algorithm::pooling_avg_exclude_padding);
                break;
            case operation::kind::relu:
                add_relu(o);
                break;
            case operation::kind::concatenation:
                add_concatenation(o);
                break;
            case operation::kind::dense:
                add_dense(o, batch);
                break;
            }
        const tactnet::shape out = network.maps()[network.operations().back().output];
        const dnnl::memory::desc found = maps_[network.operations().back().output].get_desc();
        result_ = as(network.operations().back().output,
                     found.dims().size() == 2
                         ? dnnl::memory::desc({number(batch), number(out.channels)}, f32, tag::nc)
                         : dnnl::memory::desc(shape_of(batch, out), f32, tag::nchw));
        stream_.wait();
    }

    void run(std::span<const float> frames, std::span<float> logits) override {
        std::copy(frames.begin(), frames.end(), static_cast<float*>(maps_[0].get_data_handle()));
        for (auto& [primitive, arguments] : steps_)
            primitive.execute(stream_, arguments);
        stream_.wait();
        std::copy_n(static_cast<const float*>(result_.get_data_handle()), logits.size(), logits.begin());
    }

private:
    static dims shape_of(std::size_t batch, tactnet::shape s) {
        return {number(batch), number(s.channels), number(s.rows), number(s.columns)};
    }
    static dims before(const tactnet::sliding_window& w) { return {number(w.top), number(w.left)}; }
    /// oneDNN wants the padding that makes its own count of outputs come out.
    static dims behind(const tactnet::sliding_window& w) {
        const auto missing = [](std::size_t reach, std::size_t size) {
            return number(reach > size ? reach - size : 0);
        };
        return {missing((w.output_rows() - 1) * w.stride.rows + w.kernel.rows, w.input.rows + w.top),
                missing((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                        w.input.columns + w.left)};
    }

    void add_convolution(const operation& o, std::size_t batch) {
        const dims kernel{number(o.to.channels), number(o.from.channels), number(o.window.kernel.rows),
                          number(o.window.kernel.columns)};
        dnnl::post_ops after;
        if (o.accumulates)
            after.append_sum(1.0f);
        if (o.relu)
            after.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, 0.0f, 0.0f);
        dnnl::primitive_attr attributes;
        attributes.set_post_ops(after);
        const dnnl::convolution_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
            {shape_of(batch, o.from), f32, tag::any}, {kernel, f32, tag::any},
            {{number(o.to.channels)}, f32, tag::a}, {shape_of(batch, o.to), f32, tag::any},
            {number(o.window.stride.rows), number(o.window.stride.columns)}, before(o.window),
            behind(o.window));
        const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine_);
        const dnnl::memory in = as(o.input, chosen.src_desc());
        const dnnl::memory weights = packed({kernel, f32, tag::oihw}, o.weights, chosen.weights_desc());
        const dnnl::memory bias = packed({{number(o.to.channels)}, f32, tag::a}, o.bias, chosen.bias_desc());
        if (o.accumulates && maps_[o.output].get_desc() != chosen.dst_desc()) {
            // The sum is taken in place, so the other term must be in the convolution's layout.
            const dnnl::memory term = maps_[o.output];
            const dnnl::memory sum(chosen.dst_desc(), engine_);
            add(dnnl::reorder(term, sum), {{DNNL_ARG_FROM, term}, {DNNL_ARG_TO, sum}});
            maps_[o.output] = sum;
        } else if (!o.accumulates) {
            maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        }
        add(dnnl::convolution_forward(chosen), {{DNNL_ARG_SRC, in},
                                                {DNNL_ARG_WEIGHTS, weights},
                                                {DNNL_ARG_BIAS, bias},
                                                {DNNL_ARG_DST, maps_[o.output]}});
    }

    void add_pool(const operation& o, std::size_t batch, dnnl::algorithm how) {
        const dnnl::pooling_forward::desc description(
            dnnl::prop_kind::forward_inference, how, maps_[o.input].get_desc(),
            {shape_of(batch, o.to), f32, tag::any},
            {number(o.window.stride.rows), number(o.window.stride.columns)},
            {number(o.window.kernel.rows), number(o.window.kernel.columns)}, before(o.window),
            behind(o.window));
        const dnnl::pooling_forward::primitive_desc chosen(description, engine_);
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        add(dnnl::pooling_forward(chosen), {{DNNL_ARG_SRC, maps_[o.input]}, {DNNL_ARG_DST, maps_[o.output]}});
    }

    void add_relu(const operation& o) {
        const dnnl::memory in = maps_[o.input];
        const dnnl::eltwise_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::eltwise_relu, in.get_desc(), 0.0f, 0.0f);
        maps_[o.output] = dnnl::memory(in.get_desc(), engine_);
        add(dnnl::eltwise_forward({description, engine_}),
            {{DNNL_ARG_SRC, in}, {DNNL_ARG_DST, maps_[o.output]}});
    }

    void add_concatenation(const operation& o) {
        std::vector<dnnl::memory::desc> descriptions;
        std::unordered_map<int, dnnl::memory> arguments;
        for (const std::size_t map : o.inputs) {
            arguments[DNNL_ARG_MULTIPLE_SRC + static_cast<int>(descriptions.size())] = maps_[map];
            descriptions.push_back(maps_[map].get_desc());
        }
        const dnnl::concat::primitive_desc chosen(1, descriptions, engine_);
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        arguments[DNNL_ARG_DST] = maps_[o.output];
        add(dnnl::concat(chosen), std::move(arguments));
    }

    void add_dense(const operation& o, std::size_t batch) {
        // Behind a dense layer maps have lost their rows and columns.
        dims kernel{number(o.to.channels), number(o.from.channels)};
        const bool flat = maps_[o.input].get_desc().dims().size() == 2;
        if (!flat)
            kernel.insert(kernel.end(), {number(o.from.rows), number(o.from.columns)});
        dims from = kernel;
        from[0] = number(batch);
        const dnnl::inner_product_forward::desc description(
            dnnl::prop_kind::forward_inference, {from, f32, tag::any}, {kernel, f32, tag::any},
            {{number(o.to.channels)}, f32, tag::a}, {{number(batch), number(o.to.channels)}, f32, tag::nc});
        const dnnl::inner_product_forward::primitive_desc chosen(description, engine_);
        const dnnl::memory in = as(o.input, chosen.src_desc());
        const dnnl::memory weights =
            packed({kernel, f32, flat ? tag::ab : tag::oihw}, o.weights, chosen.weights_desc());
        const dnnl::memory bias = packed({{number(o.to.channels)}, f32, tag::a}, o.bias, chosen.bias_desc());
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        add(dnnl::inner_product_forward(chosen), {{DNNL_ARG_SRC, in},
                                                  {DNNL_ARG_WEIGHTS, weights},
                                                  {DNNL_ARG_BIAS, bias},
                                                  {DNNL_ARG_DST, maps_[o.output]}});
    }

    /// A map in the layout that an operation prefers, reordered on each run if it must be.
    dnnl::memory as(std::size_t map, const dnnl::memory::desc& wanted) {
        const dnnl::memory have = maps_[map];
        if (have.get_desc() == wanted)
            return have;
        const dnnl::memory copy(wanted, engine_);
        add(dnnl::reorder(have, copy), {{DNNL_ARG_FROM, have}, {DNNL_ARG_TO, copy}});
        return copy;
    }
    /// Constants, reordered once.
    dnnl::memory packed(const dnnl::memory::desc& plain, const std::vector<float>& values,
                        const dnnl::memory::desc& wanted) {
        const dnnl::memory from(plain, engine_);
        std::copy(values.begin(), values.end(), static_cast<float*>(from.get_data_handle()));
        const dnnl::memory to(wanted, engine_);
        dnnl::reorder(from, to).execute(stream_, {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
        stream_.wait();
        return to;
    }
    void add(dnnl::primitive primitive, std::unordered_map<int, dnnl::memory> arguments) {
        steps_.emplace_back(std::move(primitive), std::move(arguments));
    }

    dnnl::engine engine_;
    dnnl::stream stream_;
    std::vector<dnnl::memory> maps_;
    std::vector<std::pair<dnnl::primitive, std::unordered_map<int, dnnl::memory>>> steps_;
    dnnl::memory result_;
};

} // namespace

std::unique_ptr<peer> make_onednn(const described_network& network, std::size_t batch, std::size_t threads) {
    return std::make_unique<onednn>(network, batch, threads);
}

} // namespace benchmark
