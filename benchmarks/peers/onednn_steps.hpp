#pragma once

// What networks of floats and of bytes share as primitives of oneDNN that run one after the other. Included
// by onednn.cpp and onednn_8bit.cpp.

#include "../support/described_network.hpp"
#include "peer.hpp"

#include <algorithm>
#include <dnnl.hpp>
#include <omp.h>
#include <unordered_map>
#include <utility>
#include <vector>

namespace benchmark {

template <class Peer, class Number>
class onednn_steps : public Peer {
public:
    void run(std::span<const Number> frames, std::span<float> logits) override {
        std::copy(frames.begin(), frames.end(), static_cast<Number*>(maps_[0].get_data_handle()));
        for (auto& [primitive, arguments] : steps_)
            primitive.execute(stream_, arguments);
        stream_.wait();
        std::copy_n(static_cast<const float*>(result_.get_data_handle()), logits.size(), logits.begin());
    }

protected:
    using tag = dnnl::memory::format_tag;
    using type = dnnl::memory::data_type;
    using dims = dnnl::memory::dims;
    /// What the numbers of a layer are stored as.
    struct types {
        type in, weights, bias, out;
    };

    onednn_steps(const described_network& network, std::size_t batch, std::size_t threads, type frames)
        : engine_(dnnl::engine::kind::cpu, 0), stream_(engine_), batch_(batch) {
        omp_set_num_threads(static_cast<int>(threads));
        maps_.resize(network.maps().size());
        maps_[0] = dnnl::memory({shape_of(network.maps().front()), frames, tag::nchw}, engine_);
    }

    static dnnl::memory::dim number(std::size_t value) { return static_cast<dnnl::memory::dim>(value); }
    [[nodiscard]] dims shape_of(tactnet::shape s) const {
        return {number(batch_), number(s.channels), number(s.rows), number(s.columns)};
    }
    static dims kernel_of(const operation& o) {
        return {number(o.to.channels), number(o.from.channels), number(o.window.kernel.rows),
                number(o.window.kernel.columns)};
    }
    static dims strides(const operation& o) {
        return {number(o.window.stride.rows), number(o.window.stride.columns)};
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

    /// After a convolution: a sum with the output's map, `term` times what lies there, and a ReLU.
    static dnnl::primitive_attr attributes_of(const operation& o, float term, type of_term) {
        dnnl::post_ops after;
        if (o.accumulates)
            after.append_sum(term, of_term);
        if (o.relu)
            after.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, 0.0f, 0.0f);
        dnnl::primitive_attr attributes;
        attributes.set_post_ops(after);
        return attributes;
    }
    [[nodiscard]] dnnl::convolution_forward::primitive_desc
    convolution(const operation& o, const types& t, const dnnl::primitive_attr& attributes) const {
        const dnnl::convolution_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
            {shape_of(o.from), t.in, tag::any}, {kernel_of(o), t.weights, tag::any},
            {{number(o.to.channels)}, t.bias, tag::a}, {shape_of(o.to), t.out, tag::any}, strides(o),
            before(o.window), behind(o.window));
        return {description, attributes, engine_};
    }
    /// `kernel`: filters, channels and, unless the map has lost them, rows and columns.
    [[nodiscard]] dnnl::inner_product_forward::primitive_desc
    dense(const operation& o, const dims& kernel, const types& t,
          const dnnl::primitive_attr& attributes) const {
        dims from = kernel;
        from[0] = number(batch_);
        const dnnl::inner_product_forward::desc description(
            dnnl::prop_kind::forward_inference, {from, t.in, tag::any}, {kernel, t.weights, tag::any},
            {{number(o.to.channels)}, t.bias, tag::a},
            {{number(batch_), number(o.to.channels)}, t.out, tag::nc});
        return {description, attributes, engine_};
    }
    /// Adds what was chosen for a layer with weights, which lie as `plain` says; its output has a map.
    template <class Primitive, class Weight, class Bias>
    void add_layer(const typename Primitive::primitive_desc& chosen, const operation& o,
                   const dnnl::memory::desc& plain, const std::vector<Weight>& weights,
                   const std::vector<Bias>& bias) {
        const dnnl::memory in = as(o.input, chosen.src_desc());
        add(Primitive(chosen), {{DNNL_ARG_SRC, in},
                                {DNNL_ARG_WEIGHTS, packed(plain, weights, chosen.weights_desc())},
                                {DNNL_ARG_BIAS, packed(chosen.bias_desc(), bias, chosen.bias_desc())},
                                {DNNL_ARG_DST, maps_[o.output]}});
    }
    /// A pool, of the largest or of the average.
    void add_pool(const operation& o) {
        const dnnl::memory::desc in = maps_[o.input].get_desc();
        const dnnl::pooling_forward::desc description(
            dnnl::prop_kind::forward_inference,
            o.what == operation::kind::pool ? dnnl::algorithm::pooling_max
                                            : dnnl::algorithm::pooling_avg_exclude_padding,
            in, {shape_of(o.to), in.data_type(), tag::any}, strides(o),
            {number(o.window.kernel.rows), number(o.window.kernel.columns)}, before(o.window),
            behind(o.window));
        const dnnl::pooling_forward::primitive_desc chosen(description, engine_);
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        add(dnnl::pooling_forward(chosen), {{DNNL_ARG_SRC, maps_[o.input]}, {DNNL_ARG_DST, maps_[o.output]}});
    }
    void add_concatenation(const operation& o) {
        std::vector<dnnl::memory::desc> descriptions;
        std::unordered_map<int, dnnl::memory> arguments;
        for (const std::size_t map : o.inputs) {
            arguments[DNNL_ARG_MULTIPLE_SRC + static_cast<int>(descriptions.size())] = maps_[map];
            descriptions.push_back(maps_[map].get_desc());
        }
        const dnnl::concat::primitive_desc chosen(1, descriptions, engine_);
        maps_[o.output] = arguments[DNNL_ARG_DST] = dnnl::memory(chosen.dst_desc(), engine_);
        add(dnnl::concat(chosen), std::move(arguments));
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
    void add(dnnl::primitive primitive, std::unordered_map<int, dnnl::memory> arguments) {
        steps_.emplace_back(std::move(primitive), std::move(arguments));
    }

    dnnl::engine engine_;
    dnnl::stream stream_;
    const std::size_t batch_;
    std::vector<dnnl::memory> maps_;
    std::vector<std::pair<dnnl::primitive, std::unordered_map<int, dnnl::memory>>> steps_;
    dnnl::memory result_;

private:
    /// Constants, reordered once.
    template <class Constant>
    dnnl::memory packed(const dnnl::memory::desc& plain, const std::vector<Constant>& values,
                        const dnnl::memory::desc& wanted) {
        const dnnl::memory from(plain, engine_);
        std::copy(values.begin(), values.end(), static_cast<Constant*>(from.get_data_handle()));
        const dnnl::memory to(wanted, engine_);
        dnnl::reorder(from, to).execute(stream_, {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
        stream_.wait();
        return to;
    }
};

} // namespace benchmark
