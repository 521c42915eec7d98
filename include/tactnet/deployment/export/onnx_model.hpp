#pragma once

#include <tactnet/deployment/export/onnx_elementwise.hpp>
#include <tactnet/deployment/export/onnx_graph.hpp>
#include <tactnet/deployment/export/onnx_layers.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <algorithm>
#include <array>
#include <cmath>
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

/// Counts at most 255 after 255 · log(1 + x ÷ unit) ÷ log(1 + 255 ÷ knee), or √(255 x). Without the rounding
/// of input_function.
[[gnu::cold]] inline std::string add_input_function(onnx_graph& g, std::string counts,
                                                    const input_function& function) {
    if (function.identity())
        return counts;
    const float knee = function.knee;
    counts = g.node("Max", {counts, g.constant(0.0F)});
    if (function.rule == count_rule::square_root) {
        counts = g.node("Sqrt", {g.node("Mul", {counts, g.constant(255.0F)})});
    } else {
        std::string unit = g.constant(knee);
        if (function.rule == count_rule::relative_logarithm) { // without contact 0, whatever divides it
            const std::string mean = g.node("ReduceMean", {counts}, {onnx_attribute("axes", {1, 2, 3})});
            unit = g.node("Max", {g.node("Mul", {mean, unit}), g.constant(1e-30F)});
        }
        const std::string shifted = g.node("Add", {g.node("Div", {counts, unit}), g.constant(1.0F)});
        counts = g.node("Mul", {g.node("Log", {shifted}), g.constant(255 / std::log(1 + 255 / knee))});
    }
    return g.node("Min", {counts, g.constant(255.0F)});
}

} // namespace detail

/// Whether `onnx_model` writes the network: all layers but those of sequences, adaptive pools of several
/// bins, `square_root`, and your own.
template <class Network>
concept has_onnx_form = detail::onnx_layer<typename Network::specification>::exists;

/// The bytes of an ONNX file (operator set 17) of a trained network. Its input `counts` is [batch, channels,
/// rows, columns] of counts, which the model compresses and normalises; its output [batch, outputs] is
/// `logits`, or `probabilities` of a network that ends in a softmax. The names of classes are the property
/// `classes`, one a line. Layers stay as they are: runtimes fold batch norms by themselves. Throws
/// std::invalid_argument for a network whose weights are all zero.
template <class Network>
[[nodiscard]] [[gnu::cold]] std::string
onnx_model(const Network& network, std::span<const float, Network::input_shape.size()> mean, float scale,
           std::span<const std::string> classes, const input_function& function = {}) {
    static_assert(
        has_onnx_form<Network>,
        "onnx_model: the network has a layer without a form in ONNX; has_onnx_form lists which have one");
    constexpr shape in = Network::input_shape;
    detail::check_trained("onnx_model", network);
    detail::onnx_graph g;
    detail::onnx_tensor at{"counts"};
    at.name = detail::add_input_function(g, at.name, function);
    if (std::any_of(mean.begin(), mean.end(), [](float value) { return value != 0; }))
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
                      m.normalise.scale, m.classes, m.normalise.function);
}

}} // namespace tactnet
