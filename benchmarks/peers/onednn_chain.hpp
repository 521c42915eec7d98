#pragma once

#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <dnnl.hpp>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace benchmark {

/// oneDNN's primitives one after the other, for one frame of floats or of bytes. The frame begins in a given
/// layout; each convolution chooses its own, and a map is reordered where two disagree.
template <class Number>
class onednn_chain {
    static constexpr bool bytes = std::is_same_v<Number, std::uint8_t>;
    using type = dnnl::memory::data_type;

public:
    using tag = dnnl::memory::format_tag;
    using dims = dnnl::memory::dims;
    using weight = std::conditional_t<bytes, std::int8_t, float>;
    using bias = std::conditional_t<bytes, std::int32_t, float>;

    onednn_chain(tactnet::shape input, tag layout)
        : in_({shape_of(input), of_maps, layout}, engine_), map_(in_), size_(input) {}

    /// Pixel by pixel, without gaps.
    void set_input(std::span<const Number> input) {
        dnnl::memory from({shape_of(first_), of_maps, tag::nhwc}, engine_);
        std::copy(input.begin(), input.end(), static_cast<Number*>(from.get_data_handle()));
        once(dnnl::reorder(from, in_), {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, in_}});
    }
    [[nodiscard]] std::vector<Number> output() {
        dnnl::memory to({shape_of(size_), of_maps, tag::nhwc}, engine_);
        once(dnnl::reorder(map_, to), {{DNNL_ARG_FROM, map_}, {DNNL_ARG_TO, to}});
        const auto* const values = static_cast<const Number*>(to.get_data_handle());
        return {values, values + size_.size()};
    }
    void run() {
        for (auto& [primitive, arguments] : steps_)
            primitive.execute(stream_, arguments);
        stream_.wait();
    }

    /// A function of each element.
    struct function {
        dnnl::algorithm kind = dnnl::algorithm::undef;
        float alpha = 0, beta = 0;
    };
    struct geometry {
        tactnet::sliding_window window; ///< with the padding of the dilated kernel
        std::size_t filters, groups = 1;
        tactnet::extent2d dilation = 1;
        function after = {}; ///< the convolution's post-op
        float factor = 1;    ///< of sums in bytes
    };
    void convolution(const geometry& g, std::span<const weight> weights, std::span<const bias> biases) {
        const auto& w = g.window;
        const auto reach = [](std::size_t kernel, std::size_t apart) { return (kernel - 1) * apart + 1; };
        const auto outputs = [&](std::size_t size, std::size_t kernel, std::size_t stride) {
            return (size - kernel) / stride + 1;
        };
        const tactnet::shape to{
            outputs(w.input.rows + w.top + w.bottom, reach(w.kernel.rows, g.dilation.rows), w.stride.rows),
            outputs(w.input.columns + w.left + w.right, reach(w.kernel.columns, g.dilation.columns),
                    w.stride.columns),
            g.filters};
        dims kernel{number(g.filters / g.groups), number(w.input.channels / g.groups), number(w.kernel.rows),
                    number(w.kernel.columns)};
        if (g.groups > 1)
            kernel.insert(kernel.begin(), number(g.groups));
        dnnl::post_ops after;
        if (g.after.kind != dnnl::algorithm::undef)
            after.append_eltwise(1.0f, g.after.kind, g.after.alpha, g.after.beta);
        dnnl::primitive_attr attributes;
        attributes.set_post_ops(after);
        if (bytes)
            attributes.set_output_scales(1 << 1, std::vector<float>(g.filters, g.factor));
        const dnnl::convolution_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
            {shape_of(size_), of_maps, tag::any}, {kernel, of_weights, tag::any},
            {{number(g.filters)}, of_biases, tag::a}, {shape_of(to), of_maps, tag::any},
            {number(w.stride.rows), number(w.stride.columns)},
            {number(g.dilation.rows - 1), number(g.dilation.columns - 1)}, {number(w.top), number(w.left)},
            {number(w.bottom), number(w.right)});
        const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine_);
        finish_convolution(chosen, dnnl::convolution_forward(chosen), to,
                           {kernel, of_weights, g.groups > 1 ? tag::goihw : tag::oihw}, weights, biases);
    }
    /// Weights are [channel][filter][row][column], as PyTorch's.
    void deconvolution(tactnet::shape to, tactnet::extent2d kernel, tactnet::extent2d stride,
                       tactnet::padding crop, std::span<const weight> weights, std::span<const bias> biases) {
        const dims size{number(to.channels), number(size_.channels), number(kernel.rows),
                        number(kernel.columns)};
        const dnnl::deconvolution_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::deconvolution_direct,
            {shape_of(size_), of_maps, tag::any}, {size, of_weights, tag::any},
            {{number(to.channels)}, of_biases, tag::a}, {shape_of(to), of_maps, tag::any},
            {number(stride.rows), number(stride.columns)}, {number(crop.top), number(crop.left)},
            {number(crop.bottom), number(crop.right)});
        const dnnl::deconvolution_forward::primitive_desc chosen(description, engine_);
        finish_convolution(chosen, dnnl::deconvolution_forward(chosen), to, {size, of_weights, tag::iohw},
                           weights, biases);
    }
    void pool(const tactnet::sliding_window& w, dnnl::algorithm how) {
        const tactnet::shape to{w.output_rows(), w.output_columns(), w.input.channels};
        const dnnl::pooling_forward::desc description(
            dnnl::prop_kind::forward_inference, how, map_.get_desc(), {shape_of(to), of_maps, tag::any},
            {number(w.stride.rows), number(w.stride.columns)},
            {number(w.kernel.rows), number(w.kernel.columns)}, {number(w.top), number(w.left)},
            {number(w.bottom), number(w.right)});
        const dnnl::pooling_forward::primitive_desc chosen(description, engine_);
        append(dnnl::pooling_forward(chosen), chosen.dst_desc(), to);
    }
    void resample(tactnet::shape to, dnnl::algorithm how) {
        const dnnl::resampling_forward::desc description(dnnl::prop_kind::forward_inference, how,
                                                         map_.get_desc(), {shape_of(to), of_maps, tag::any});
        const dnnl::resampling_forward::primitive_desc chosen(description, engine_);
        append(dnnl::resampling_forward(chosen), chosen.dst_desc(), to);
    }
    void eltwise(const function& f) {
        const dnnl::eltwise_forward::desc description(dnnl::prop_kind::forward_inference, f.kind,
                                                      map_.get_desc(), f.alpha, f.beta);
        const dnnl::eltwise_forward::primitive_desc chosen(description, engine_);
        append(dnnl::eltwise_forward(chosen), chosen.dst_desc(), size_);
    }
    void prelu(std::span<const float> slopes) {
        const dims size{1, number(size_.channels), 1, 1};
        const dnnl::prelu_forward::desc description(dnnl::prop_kind::forward_inference, map_.get_desc(),
                                                    {size, type::f32, tag::any});
        const dnnl::prelu_forward::primitive_desc chosen(description, engine_);
        append(dnnl::prelu_forward(chosen), chosen.dst_desc(), size_,
               {{DNNL_ARG_WEIGHTS, reordered({size, type::f32, tag::nchw}, slopes, chosen.weights_desc())}});
    }
    /// Over the last of these dimensions, of a map that lies pixel by pixel.
    void layer_norm(const dims& size, tag layout, std::span<const float> scales,
                    std::span<const float> shifts, float epsilon) {
        if (map_.get_desc() != dnnl::memory::desc(shape_of(size_), type::f32, tag::nhwc))
            throw dnnl::error(dnnl_unimplemented, "layer_norm: the map must lie pixel by pixel");
        using flags = dnnl::normalization_flags;
        const dnnl::memory::desc map(size, type::f32, layout);
        const dnnl::layer_normalization_forward::desc description(
            dnnl::prop_kind::forward_inference, map, epsilon, flags::use_scale | flags::use_shift);
        const dnnl::layer_normalization_forward::primitive_desc chosen(description, engine_);
        const dnnl::memory::desc line({number(scales.size())}, type::f32, tag::a);
        const dnnl::memory in(map, engine_, map_.get_data_handle());
        const dnnl::memory out(map_.get_desc(), engine_);
        steps_.emplace_back(
            dnnl::layer_normalization_forward(chosen),
            std::unordered_map<int, dnnl::memory>{{DNNL_ARG_SRC, in},
                                                  {DNNL_ARG_SCALE, reordered(line, scales, line)},
                                                  {DNNL_ARG_SHIFT, reordered(line, shifts, line)},
                                                  {DNNL_ARG_DST, {map, engine_, out.get_data_handle()}}});
        kept_.push_back(map_);
        map_ = out;
    }
    /// The map that the chain began with times the present one, which has one pixel.
    void multiply_input() {
        const dnnl::binary::desc description(dnnl::algorithm::binary_mul, in_.get_desc(), map_.get_desc(),
                                             in_.get_desc());
        const dnnl::binary::primitive_desc chosen(description, engine_);
        const dnnl::memory factors = map_;
        map_ = dnnl::memory(chosen.dst_desc(), engine_), size_ = first_;
        steps_.emplace_back(dnnl::binary(chosen),
                            std::unordered_map<int, dnnl::memory>{
                                {DNNL_ARG_SRC_0, in_}, {DNNL_ARG_SRC_1, factors}, {DNNL_ARG_DST, map_}});
    }

private:
    static constexpr type of_maps = bytes ? type::u8 : type::f32, of_weights = bytes ? type::s8 : type::f32,
                          of_biases = bytes ? type::s32 : type::f32;

    static dnnl::memory::dim number(std::size_t value) { return static_cast<dnnl::memory::dim>(value); }
    static dims shape_of(tactnet::shape s) {
        return {1, number(s.channels), number(s.rows), number(s.columns)};
    }
    void once(dnnl::primitive primitive, const std::unordered_map<int, dnnl::memory>& arguments) {
        primitive.execute(stream_, arguments);
        stream_.wait();
    }
    template <class T>
    dnnl::memory reordered(const dnnl::memory::desc& plain, std::span<const T> values,
                           const dnnl::memory::desc& wanted) {
        dnnl::memory from(plain, engine_), to(wanted, engine_);
        std::copy(values.begin(), values.end(), static_cast<T*>(from.get_data_handle()));
        once(dnnl::reorder(from, to), {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
        return to;
    }
    void append(dnnl::primitive primitive, const dnnl::memory::desc& to, tactnet::shape size,
                std::unordered_map<int, dnnl::memory> arguments = {}) {
        arguments[DNNL_ARG_SRC] = map_;
        map_ = dnnl::memory(to, engine_), size_ = size;
        arguments[DNNL_ARG_DST] = map_;
        steps_.emplace_back(std::move(primitive), std::move(arguments));
    }
    void finish_convolution(const auto& chosen, dnnl::primitive primitive, tactnet::shape to,
                            const dnnl::memory::desc& plain, std::span<const weight> weights,
                            std::span<const bias> biases) {
        if (map_.get_desc() != chosen.src_desc()) {
            const dnnl::memory copy(chosen.src_desc(), engine_);
            if (steps_.empty())
                in_ = copy; // the frame comes in the layout that the first one prefers
            else
                steps_.emplace_back(
                    dnnl::reorder(map_, copy),
                    std::unordered_map<int, dnnl::memory>{{DNNL_ARG_FROM, map_}, {DNNL_ARG_TO, copy}});
            map_ = copy;
        }
        const dnnl::memory::desc line({number(to.channels)}, of_biases, tag::a);
        append(std::move(primitive), chosen.dst_desc(), to,
               {{DNNL_ARG_WEIGHTS, reordered(plain, weights, chosen.weights_desc())},
                {DNNL_ARG_BIAS, reordered(line, biases, line)}});
    }

    dnnl::engine engine_{dnnl::engine::kind::cpu, 0};
    dnnl::stream stream_{engine_};
    dnnl::memory in_, map_;
    tactnet::shape size_, first_ = size_;
    std::vector<dnnl::memory> kept_;
    std::vector<std::pair<dnnl::primitive, std::unordered_map<int, dnnl::memory>>> steps_;
};

} // namespace benchmark
