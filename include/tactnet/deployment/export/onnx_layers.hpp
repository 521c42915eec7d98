#pragma once

#include <tactnet/deployment/export/onnx_graph.hpp>
#include <tactnet/operators.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// How layers with windows are written as ONNX, and dense layers: convolutions, pools, resampling.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Where the arrays of a layer begin.
struct onnx_parameters {
    const float *values, *statistics;
    float epsilon;

    [[nodiscard]] onnx_parameters after(std::size_t parameters, std::size_t of_statistics) const {
        return {values + parameters, statistics + of_statistics, epsilon};
    }
    [[nodiscard]] onnx_parameters after(const layer_offset& o) const {
        return after(o.parameters, o.statistics);
    }
};

/// A tensor: [batch, channels], if it is flat, or [batch, channels, rows, columns].
struct onnx_tensor {
    std::string name;
    bool flat = false;

    [[nodiscard]] std::string map(onnx_graph& g) const {
        return flat ? g.node("Unsqueeze", {name, g.whole_numbers({2, 3})}) : name;
    }
};

/// How a layer is written: add<layer>(graph, input, parameters). A layer without a specialisation is not
/// exported.
template <class Spec>
struct onnx_layer {
    static constexpr bool exists = false;
};
struct onnx_form {
    static constexpr bool exists = true;
};

[[nodiscard]] inline onnx_message onnx_extent(std::string_view name, extent2d e) {
    return onnx_attribute(name, {e.rows, e.columns});
}

/// `Plain` states groups and bias, `Layer` the window and the output.
template <class Plain, class Layer>
std::string onnx_convolution(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p,
                             extent2d dilation) {
    constexpr sliding_window w = Layer::window;
    constexpr std::size_t filters = Layer::output.channels,
                          weights = Layer::parameters - (Plain::has_bias ? filters : 0);
    std::vector<std::string> inputs{
        in.map(g), g.constant({p.values, weights}, {filters, weights / filters / w.kernel.area(),
                                                    w.kernel.rows, w.kernel.columns})};
    if constexpr (Plain::has_bias)
        inputs.push_back(g.constant({p.values + weights, filters}, {filters}));
    return g.node("Conv", inputs,
                  {onnx_extent("kernel_shape", w.kernel), onnx_extent("strides", w.stride),
                   onnx_extent("dilations", dilation), onnx_attribute("group", Plain::groups),
                   onnx_attribute("pads", {w.top, w.left, w.bottom, w.right})});
}
template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, conv2d_options Options>
struct onnx_layer<conv2d<Filters, Kernel, Stride, Padding, Options>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        return {onnx_convolution<Layer, Layer>(g, in, p, 1)};
    }
};
template <std::size_t Filters, extent2d Kernel, extent2d Dilation, extent2d Stride, padding Padding,
          conv2d_options Options>
struct onnx_layer<dilated_conv2d<Filters, Kernel, Dilation, Stride, Padding, Options>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        return {onnx_convolution<typename Layer::convolution, Layer>(g, in, p, Layer::dilation)};
    }
};
template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, bool Bias>
struct onnx_layer<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        std::vector<std::string> inputs{
            in.map(g), g.constant({p.values, Layer::weights},
                                  {Layer::input.channels, Filters, Kernel.rows, Kernel.columns})};
        if constexpr (Bias)
            inputs.push_back(g.constant({p.values + Layer::weights, Filters}, {Filters}));
        // What is cropped at the end, or added to it.
        constexpr std::size_t rows =
                                  uncropped(Layer::input.rows, Kernel.rows, Stride.rows) - Layer::window.top,
                              columns = uncropped(Layer::input.columns, Kernel.columns, Stride.columns) -
                                        Layer::window.left;
        const auto beyond = [](std::size_t one, std::size_t other) { return one > other ? one - other : 0; };
        return {g.node(
            "ConvTranspose", inputs,
            {onnx_extent("strides", Stride),
             onnx_attribute("pads", {Layer::window.top, Layer::window.left, beyond(rows, Layer::output.rows),
                                     beyond(columns, Layer::output.columns)}),
             onnx_attribute("output_padding",
                            {beyond(Layer::output.rows, rows), beyond(Layer::output.columns, columns)})})};
    }
};
template <std::size_t Outputs>
struct onnx_layer<dense<Outputs>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        return {g.node("Gemm",
                       {in.flat ? in.name : g.node("Flatten", {in.name}),
                        g.constant({p.values, Layer::weights}, {Outputs, Layer::inputs}),
                        g.constant({p.values + Layer::weights, Outputs}, {Outputs})},
                       {onnx_attribute("transB", std::size_t{1})}),
                true};
    }
};

/// A pool of a window, or of all pixels.
template <extent2d Window, extent2d Stride, padding Padding>
struct onnx_layer<max_pool<Window, Stride, Padding>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        constexpr sliding_window w = Layer::window;
        return {g.node("MaxPool", {in.map(g)},
                       {onnx_extent("kernel_shape", w.kernel), onnx_extent("strides", w.stride),
                        onnx_attribute("pads", {w.top, w.left, w.bottom, w.right})})};
    }
};
template <>
struct onnx_layer<global_max_pool> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        return {g.node("GlobalMaxPool", {in.map(g)})};
    }
};
template <extent2d Window, extent2d Stride, padding Padding, average_over Over>
struct onnx_layer<average_pool<Window, Stride, Padding, Over>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        constexpr auto r = Layer::windows.rows, c = Layer::windows.columns;
        // What ceil mode adds after the given padding does not count.
        const bool completed = (r.size + r.before + r.after - r.kernel) / r.stride + 1 < r.outputs ||
                               (c.size + c.before + c.after - c.kernel) / c.stride + 1 < c.outputs;
        return {g.node("AveragePool", {in.map(g)},
                       {onnx_extent("kernel_shape", Window), onnx_extent("strides", Stride),
                        onnx_attribute("pads", {r.before, c.before, r.after, c.after}),
                        onnx_attribute("ceil_mode", std::size_t{completed}),
                        onnx_attribute("count_include_pad", std::size_t{Layer::windows.counts_padding})})};
    }
};
template <>
struct onnx_layer<global_average_pool> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        return {g.node("GlobalAveragePool", {in.map(g)})};
    }
};
/// Positions as PyTorch has them.
template <class Layer>
onnx_tensor onnx_resize(onnx_graph& g, const onnx_tensor& in) {
    constexpr bool nearest = Layer::mode == interpolation::nearest;
    const std::string size =
        g.whole_numbers({1, Layer::output.channels, Layer::output.rows, Layer::output.columns});
    return {g.node(
        "Resize", {in.map(g), "", "", size},
        {onnx_attribute("mode", nearest ? "nearest" : "linear"), onnx_attribute("nearest_mode", "floor"),
         onnx_attribute("coordinate_transformation_mode", nearest ? "asymmetric" : "half_pixel")})};
}
template <extent2d Factor, interpolation Mode>
struct onnx_layer<upsample<Factor, Mode>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        return onnx_resize<Layer>(g, in);
    }
};
template <extent2d Size, interpolation Mode>
struct onnx_layer<upsample_to<Size, Mode>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        return onnx_resize<Layer>(g, in);
    }
};

}}} // namespace tactnet::detail
