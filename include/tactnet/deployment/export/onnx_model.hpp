#pragma once

#include <tactnet/deployment/export/onnx_graph.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Writes a trained network as an ONNX file, for other runtimes: its layers as they were trained, counts as
// input. The bytes are written by onnx_graph.hpp, so that neither Python nor protobuf is needed.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

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

template <>
struct onnx_layer<batch_norm> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        constexpr std::size_t c = Layer::channels;
        return {g.node("BatchNormalization",
                       {in.name, g.constant({p.values, c}, {c}), g.constant({p.values + c, c}, {c}),
                        g.constant({p.statistics, c}, {c}), g.constant({p.statistics + c, c}, {c})},
                       {onnx_attribute("epsilon", p.epsilon)}),
                in.flat};
    }
};
template <>
struct onnx_layer<channel_scale> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        constexpr std::size_t c = Layer::input.channels;
        return {g.node("Mul", {in.map(g), g.constant({p.values, c}, {1, c, 1, 1})})};
    }
};
/// Norms of groups of channels, which a reshape to [batch, groups, …] makes channels.
template <class Layer>
onnx_tensor onnx_group_norm(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p,
                            std::size_t groups) {
    constexpr shape s = Layer::output;
    const std::vector<float> ones(groups, 1.0F), zeros(groups);
    const std::string grouped =
        g.node("Reshape", {in.map(g), g.whole_numbers({0, groups, s.size() / groups})});
    const std::string made =
        g.node("InstanceNormalization", {grouped, g.constant(ones, {groups}), g.constant(zeros, {groups})},
               {onnx_attribute("epsilon", p.epsilon)});
    const auto weights = [&](std::size_t first) {
        return g.constant({p.values + first, s.channels}, {1, s.channels, 1, 1});
    };
    const std::string ungrouped =
        g.node("Reshape", {made, g.whole_numbers({0, s.channels, s.rows, s.columns})});
    return {g.node("Add", {g.node("Mul", {ungrouped, weights(0)}), weights(s.channels)})};
}
template <std::size_t Groups>
struct onnx_layer<group_norm<Groups>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        return onnx_group_norm<Layer>(g, in, p, Groups);
    }
};
template <>
struct onnx_layer<instance_norm> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        return onnx_group_norm<Layer>(g, in, p, Layer::output.channels);
    }
};
template <>
struct onnx_layer<layer_norm<norm_over::frame>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        constexpr shape s = Layer::output;
        const auto weights = [&](std::size_t first) {
            return g.constant({p.values + first, s.size()}, {s.channels, s.rows, s.columns});
        };
        return {g.node("LayerNormalization", {in.map(g), weights(0), weights(s.size())},
                       {onnx_attribute("axis", std::size_t{1}), onnx_attribute("epsilon", p.epsilon)})};
    }
};
template <>
struct onnx_layer<layer_norm<norm_over::channels>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        constexpr std::size_t c = Layer::output.channels;
        const std::string last = g.node("Transpose", {in.map(g)}, {onnx_attribute("perm", {0, 2, 3, 1})});
        const std::string made = g.node(
            "LayerNormalization", {last, g.constant({p.values, c}, {c}), g.constant({p.values + c, c}, {c})},
            {onnx_attribute("epsilon", p.epsilon)});
        return {g.node("Transpose", {made}, {onnx_attribute("perm", {0, 3, 1, 2})})};
    }
};
template <std::size_t Size, class Alpha, class Beta, class K>
    requires(Size % 2 == 1) // of an even number, ONNX takes other channels
struct onnx_layer<local_response_norm<Size, Alpha, Beta, K>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        using rule = typename local_response_norm<Size, Alpha, Beta, K>::rule;
        return {g.node("LRN", {in.map(g)},
                       {onnx_attribute("size", Size),
                        onnx_attribute("alpha", static_cast<float>(rule::share * Size)),
                        onnx_attribute("beta", static_cast<float>(rule::beta)),
                        onnx_attribute("bias", static_cast<float>(rule::k))})};
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

/// The nodes of an activation function.
template <class Function>
inline constexpr std::string_view onnx_function = "";
template <>
inline constexpr std::string_view onnx_function<relu_function> = "Relu";
template <>
inline constexpr std::string_view onnx_function<sigmoid_function> = "Sigmoid";
template <>
inline constexpr std::string_view onnx_function<hyperbolic_tangent_function> = "Tanh";
template <>
inline constexpr std::string_view onnx_function<softplus_function> = "Softplus";
template <>
inline constexpr std::string_view onnx_function<hard_swish_function> = "HardSwish";
template <unsigned Thousandths>
inline constexpr std::string_view onnx_function<leaky_relu_function<Thousandths>> = "LeakyRelu";
template <unsigned Thousandths>
inline constexpr std::string_view onnx_function<elu_function<Thousandths>> = "Elu";
template <>
inline constexpr std::string_view onnx_function<hard_sigmoid_function> = "HardSigmoid";
template <>
inline constexpr std::string_view onnx_function<relu6_function> = "Clip";
template <>
inline constexpr std::string_view onnx_function<silu_function> = "Mul";
template <>
inline constexpr std::string_view onnx_function<gelu_function> = "Erf";

template <class Function>
    requires(!onnx_function<Function>.empty())
struct onnx_layer<activation<Function>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        constexpr std::string_view name = onnx_function<Function>;
        if constexpr (requires { Function::arguments; }) {
            const float alpha = static_cast<float>(Function::arguments[0]) / 1000;
            return {g.node(name, {in.name}, {onnx_attribute("alpha", alpha)}), in.flat};
        } else if constexpr (name == "HardSigmoid") {
            return {
                g.node(name, {in.name}, {onnx_attribute("alpha", 1.0F / 6), onnx_attribute("beta", 0.5F)}),
                in.flat};
        } else if constexpr (name == "Clip") {
            return {g.node(name, {in.name, g.constant(0), g.constant(6)}), in.flat};
        } else if constexpr (name == "Mul") { // x · sigmoid(x)
            return {g.node(name, {in.name, g.node("Sigmoid", {in.name})}), in.flat};
        } else if constexpr (name == "Erf") { // x · ½ (1 + erf(x ÷ √2))
            const std::string erf =
                g.node(name, {g.node("Div", {in.name, g.constant(std::numbers::sqrt2_v<float>)})});
            const std::string twice = g.node("Mul", {in.name, g.node("Add", {erf, g.constant(1)})});
            return {g.node("Mul", {twice, g.constant(0.5F)}), in.flat};
        } else {
            return {g.node(name, {in.name}), in.flat};
        }
    }
};
template <>
struct onnx_layer<parametric_relu> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        constexpr std::size_t c = Layer::channels;
        return {g.node("PRelu", {in.map(g), g.constant({p.values, c}, {c, 1, 1})})};
    }
};
template <unsigned Percent>
struct onnx_layer<dropout<Percent>> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph&, const onnx_tensor& in, const onnx_parameters&) {
        return in;
    }
};
template <>
struct onnx_layer<softmax> : onnx_form {
    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters&) {
        return {g.node("Softmax", {in.name}, {onnx_attribute("axis", std::size_t{1})}), in.flat};
    }
};

template <name_text Name, class Spec>
struct onnx_layer<named<Name, Spec>> : onnx_layer<Spec> {};
template <class... Specs>
struct onnx_layer<sequence<Specs...>> {
    static constexpr bool exists = (onnx_layer<Specs>::exists && ...);

    template <class Layer>
    static onnx_tensor add(onnx_graph& g, onnx_tensor in, const onnx_parameters& p) {
        [&]<std::size_t... I>(std::index_sequence<I...>) {
            ((in = onnx_layer<Specs>::template add<typename Layer::template at<I>>(
                  g, in, p.after(Layer::template parameter_offset<I>, Layer::template statistic_offset<I>))),
             ...);
        }(std::index_sequence_for<Specs...>{});
        return in;
    }
};
template <class Main, class Skip>
struct onnx_layer<residual<Main, Skip>> {
    using main_layer = onnx_layer<tactnet::as_sequence<Main>>;
    using skip_layer = onnx_layer<tactnet::as_sequence<Skip>>;
    static constexpr bool exists = main_layer::exists && skip_layer::exists;

    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        using main = typename Layer::main;
        const onnx_tensor sum = main_layer::template add<main>(g, in, p),
                          skip = skip_layer::template add<typename Layer::skip>(
                              g, in, p.after(main::parameters, main::statistics));
        return {g.node("Add", {sum.map(g), skip.map(g)})};
    }
};
template <class... Branches>
struct onnx_layer<concatenation<Branches...>> {
    static constexpr bool exists = (onnx_layer<tactnet::as_sequence<Branches>>::exists && ...);

    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        std::vector<std::string> inputs;
        [&]<std::size_t... I>(std::index_sequence<I...>) {
            (inputs.push_back(
                 onnx_layer<tactnet::as_sequence<Branches>>::template add<typename Layer::template at<I>>(
                     g, in, p.after(Layer::offsets[I]))
                     .map(g)),
             ...);
        }(std::index_sequence_for<Branches...>{});
        return {g.node("Concat", inputs, {onnx_attribute("axis", std::size_t{1})})};
    }
};
template <class... Branch>
struct onnx_layer<gate<Branch...>> {
    using branch_layer = onnx_layer<sequence<Branch...>>;
    static constexpr bool exists = branch_layer::exists;

    template <class Layer>
    static onnx_tensor add(onnx_graph& g, const onnx_tensor& in, const onnx_parameters& p) {
        const std::string x = in.map(g);
        const onnx_tensor factors = branch_layer::template add<typename Layer::branch>(g, onnx_tensor{x}, p);
        return {g.node("Mul", {x, factors.map(g)})};
    }
};

} // namespace detail

/// Whether `onnx_model` writes the network: all layers but those of sequences, adaptive pools of several
/// bins, `square_root`, and your own.
template <class Network>
concept has_onnx_form = detail::onnx_layer<typename Network::specification>::exists;

/// The bytes of an ONNX file (operator set 17) of a trained network. Its input `counts` is [batch, channels,
/// rows, columns] of counts, which the model normalises; its output [batch, outputs] is `logits`, or
/// `probabilities` of a network that ends in a softmax. The names of classes are the property `classes`, one
/// a line. Layers stay as they are: runtimes fold batch norms by themselves. Throws std::invalid_argument for
/// a network whose weights are all zero.
template <class Network>
[[nodiscard]] [[gnu::cold]] std::string onnx_model(const Network& network,
                                                   std::span<const float, Network::input_shape.size()> mean,
                                                   float scale, std::span<const std::string> classes) {
    static_assert(
        has_onnx_form<Network>,
        "onnx_model: the network has a layer without a form in ONNX; has_onnx_form lists which have one");
    constexpr shape in = Network::input_shape;
    detail::check_trained("onnx_model", network);
    detail::onnx_graph g;
    detail::onnx_tensor at{"counts"};
    if (std::ranges::any_of(mean, [](float value) { return value != 0; }))
        at.name = g.node("Sub", {at.name, g.constant(mean, {1, in.channels, in.rows, in.columns})});
    if (scale != 1)
        at.name = g.node("Mul", {at.name, g.constant(scale)});
    at = detail::onnx_layer<typename Network::specification>::template add<typename Network::layers>(
        g, at,
        {network.learnable_values().data(), network.running_statistics().data(),
         static_cast<float>(network.epsilon)});
    const std::string output = Network::ends_in_softmax ? "probabilities" : "logits";
    g.node(at.flat ? "Identity" : "Flatten", {at.name}, {}, output);
    std::string names;
    for (const std::string& name : classes)
        names += (names.empty() ? "" : "\n") + name;
    const std::array<std::pair<std::string, std::string>, 1> properties{{{"classes", names}}};
    return g.file("counts", {0, in.channels, in.rows, in.columns}, output, {0, Network::outputs}, 17,
                  properties);
}
/// The model with its normalisation and its classes.
template <class Network>
[[nodiscard]] [[gnu::cold]] std::string onnx_model(const model<Network>& m) {
    constexpr std::size_t size = Network::input_shape.size();
    return onnx_model(m.network, std::span<const float, size>(m.normalise.mean.data(), size),
                      m.normalise.scale, m.classes);
}

}} // namespace tactnet
