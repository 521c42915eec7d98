#include "../support/whole_numbers.hpp"
#include "peer.hpp"

#include <algorithm>
#include <cstdint>
#include <dnnl.hpp>
#include <omp.h>
#include <stdexcept>
#include <unordered_map>

// oneDNN's own primitives in 8 bits: bytes without a sign times bytes with one, a scale for each filter, sums
// of 32 bits.

namespace benchmark {

namespace {

using tag = dnnl::memory::format_tag;
using type = dnnl::memory::data_type;
using dims = dnnl::memory::dims;

dnnl::memory::dim number(std::size_t value) {
    return static_cast<dnnl::memory::dim>(value);
}

class onednn_8bit final : public byte_peer {
public:
    onednn_8bit(const described_network& network, std::size_t batch, std::span<const std::uint8_t> frames)
        : engine_(dnnl::engine::kind::cpu, 0), stream_(engine_) {
        omp_set_num_threads(1);
        const ranges seen(network, frames);
        maps_.resize(network.maps().size());
        scales_.resize(maps_.size(), 1);
        const tactnet::shape in = network.maps().front();
        maps_[0] = dnnl::memory(
            {{number(batch), number(in.channels), number(in.rows), number(in.columns)}, type::u8, tag::nchw},
            engine_);
        const operation& end = network.operations().back();
        for (const operation& o : network.operations()) {
            const bool last = &o == &end;
            if (o.what == operation::kind::pool)
                add_pool(o, batch, dnnl::algorithm::pooling_max);
            else if (o.what == operation::kind::average)
                add_pool(o, batch, dnnl::algorithm::pooling_avg_exclude_padding);
            else if (o.what == operation::kind::concatenation)
                add_concatenation(o);
            else if (o.what == operation::kind::dense)
                add_dense(o, batch, last);
            else
                add_convolution(o, batch, seen.largest[o.output],
                                end.what == operation::kind::average && end.input == o.output);
        }
        result_ = maps_[end.output];
        stream_.wait();
    }
    void run(std::span<const std::uint8_t> frames, std::span<float> logits) override {
        std::copy(frames.begin(), frames.end(), static_cast<std::uint8_t*>(maps_[0].get_data_handle()));
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
    static dims behind(const tactnet::sliding_window& w) {
        const auto missing = [](std::size_t reach, std::size_t size) {
            return number(reach > size ? reach - size : 0);
        };
        return {missing((w.output_rows() - 1) * w.stride.rows + w.kernel.rows, w.input.rows + w.top),
                missing((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                        w.input.columns + w.left)};
    }

    /// `floats`: writes floats, for an average pool at the end.
    void add_convolution(const operation& o, std::size_t batch, float largest, bool floats) {
        const dims kernel{number(o.to.channels), number(o.from.channels), number(o.window.kernel.rows),
                          number(o.window.kernel.columns)};
        const type output = floats ? type::f32 : o.relu ? type::u8 : type::s8;
        const float output_scale = floats ? 1 : largest / (o.relu ? 255.0f : 127.0f);
        const whole_numbers whole = quantised(o, scales_[o.input]);
        std::vector<float> factors = whole.units;
        for (float& factor : factors)
            factor /= output_scale;
        dnnl::post_ops after;
        if (o.accumulates)
            after.append_sum(scales_[o.output] / output_scale, maps_[o.output].get_desc().data_type());
        if (o.relu)
            after.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, 0.0f, 0.0f);
        dnnl::primitive_attr attributes;
        attributes.set_post_ops(after);
        attributes.set_output_scales(1 << 1, factors);
        const dnnl::convolution_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
            {shape_of(batch, o.from), maps_[o.input].get_desc().data_type(), tag::any},
            {kernel, type::s8, tag::any}, {{number(o.to.channels)}, type::s32, tag::a},
            {shape_of(batch, o.to), output, tag::any},
            {number(o.window.stride.rows), number(o.window.stride.columns)}, before(o.window),
            behind(o.window));
        const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine_);
        const dnnl::memory in = as(o.input, chosen.src_desc());
        const dnnl::memory weights =
            packed({kernel, type::s8, tag::oihw}, whole.weights, chosen.weights_desc());
        const dnnl::memory bias =
            packed({{number(o.to.channels)}, type::s32, tag::a}, whole.bias, chosen.bias_desc());
        if (o.accumulates) {
            // Taken in place, in the layout of the output; its bytes may have another sign.
            dnnl::memory term = maps_[o.output];
            dnnl::memory::desc wanted = chosen.dst_desc();
            wanted.data.data_type = static_cast<dnnl_data_type_t>(term.get_desc().data_type());
            if (term.get_desc() != wanted) {
                const dnnl::memory sum(wanted, engine_);
                add(dnnl::reorder(term, sum), {{DNNL_ARG_FROM, term}, {DNNL_ARG_TO, sum}});
                term = sum;
            }
            maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_, term.get_data_handle());
            kept_.push_back(term);
        } else {
            maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        }
        scales_[o.output] = output_scale;
        add(dnnl::convolution_forward(chosen), {{DNNL_ARG_SRC, in},
                                                {DNNL_ARG_WEIGHTS, weights},
                                                {DNNL_ARG_BIAS, bias},
                                                {DNNL_ARG_DST, maps_[o.output]}});
    }
    void add_concatenation(const operation& o) {
        std::vector<dnnl::memory::desc> descriptions;
        std::unordered_map<int, dnnl::memory> arguments;
        for (const std::size_t branch : o.inputs) {
            arguments[DNNL_ARG_MULTIPLE_SRC + static_cast<int>(descriptions.size())] = maps_[branch];
            descriptions.push_back(maps_[branch].get_desc());
        }
        const dnnl::concat::primitive_desc chosen(1, descriptions, engine_);
        maps_[o.output] = arguments[DNNL_ARG_DST] = dnnl::memory(chosen.dst_desc(), engine_);
        scales_[o.output] = scales_[o.inputs.front()];
        add(dnnl::concat(chosen), std::move(arguments));
    }
    void add_pool(const operation& o, std::size_t batch, dnnl::algorithm how) {
        const dnnl::pooling_forward::desc description(
            dnnl::prop_kind::forward_inference, how, maps_[o.input].get_desc(),
            {shape_of(batch, o.to), maps_[o.input].get_desc().data_type(), tag::any},
            {number(o.window.stride.rows), number(o.window.stride.columns)},
            {number(o.window.kernel.rows), number(o.window.kernel.columns)}, before(o.window),
            behind(o.window));
        const dnnl::pooling_forward::primitive_desc chosen(description, engine_);
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        scales_[o.output] = scales_[o.input];
        add(dnnl::pooling_forward(chosen), {{DNNL_ARG_SRC, maps_[o.input]}, {DNNL_ARG_DST, maps_[o.output]}});
    }
    void add_dense(const operation& o, std::size_t batch, bool last) {
        if (!last)
            throw std::invalid_argument("onednn_8bit: expected one dense layer, the last");
        const dims kernel{number(o.to.channels), number(o.from.channels), number(o.from.rows),
                          number(o.from.columns)};
        dims from = kernel;
        from[0] = number(batch);
        const whole_numbers whole = quantised(o, scales_[o.input]);
        dnnl::primitive_attr attributes;
        attributes.set_output_scales(1 << 1, whole.units);
        const dnnl::inner_product_forward::desc description(
            dnnl::prop_kind::forward_inference, {from, maps_[o.input].get_desc().data_type(), tag::any},
            {kernel, type::s8, tag::any}, {{number(o.to.channels)}, type::s32, tag::a},
            {{number(batch), number(o.to.channels)}, type::f32, tag::nc});
        const dnnl::inner_product_forward::primitive_desc chosen(description, attributes, engine_);
        const dnnl::memory in = as(o.input, chosen.src_desc());
        const dnnl::memory weights =
            packed({kernel, type::s8, tag::oihw}, whole.weights, chosen.weights_desc());
        const dnnl::memory bias =
            packed({{number(o.to.channels)}, type::s32, tag::a}, whole.bias, chosen.bias_desc());
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        add(dnnl::inner_product_forward(chosen), {{DNNL_ARG_SRC, in},
                                                  {DNNL_ARG_WEIGHTS, weights},
                                                  {DNNL_ARG_BIAS, bias},
                                                  {DNNL_ARG_DST, maps_[o.output]}});
    }

    dnnl::memory as(std::size_t map, const dnnl::memory::desc& wanted) {
        const dnnl::memory have = maps_[map];
        if (have.get_desc() == wanted)
            return have;
        const dnnl::memory copy(wanted, engine_);
        add(dnnl::reorder(have, copy), {{DNNL_ARG_FROM, have}, {DNNL_ARG_TO, copy}});
        return copy;
    }
    template <class Number>
    dnnl::memory packed(const dnnl::memory::desc& plain, const std::vector<Number>& values,
                        const dnnl::memory::desc& wanted) {
        const dnnl::memory from(plain, engine_);
        std::copy(values.begin(), values.end(), static_cast<Number*>(from.get_data_handle()));
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
    std::vector<dnnl::memory> maps_, kept_;
    std::vector<float> scales_; ///< what one step of each map's bytes is worth
    std::vector<std::pair<dnnl::primitive, std::unordered_map<int, dnnl::memory>>> steps_;
    dnnl::memory result_;
};

} // namespace

std::unique_ptr<byte_peer> make_onednn_8bit(const described_network& network, std::size_t batch,
                                            std::span<const std::uint8_t> frames) {
    return std::make_unique<onednn_8bit>(network, batch, frames);
}

} // namespace benchmark
