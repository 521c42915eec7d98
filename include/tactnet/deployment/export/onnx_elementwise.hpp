#pragma once

#include <tactnet/deployment/export/onnx_layers.hpp>

#include <array>
#include <cstddef>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

// How norms and activations are written as ONNX.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

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

}}} // namespace tactnet::detail
