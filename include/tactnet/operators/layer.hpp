#pragma once

#include <tactnet/tensor/named_array.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <template <class, shape> class>
struct template_of_layers;

} // namespace detail

template <class... Specs>
struct sequence;

/// The output and the costs of a layer for one sample. A specification returns them for an input of any size,
/// `Spec::costs(input)`, so that tables over many sizes instantiate no layer. The layer itself rejects inputs
/// that do not fit.
struct layer_costs {
    shape output;
    std::size_t parameters = 0;              ///< learnable: weights, biases, scales, shifts
    std::size_t statistics = 0;              ///< running means and variances
    std::size_t multiply_adds = 0;           ///< all taps
    std::size_t multiply_adds_on_pixels = 0; ///< without taps on padding
    std::size_t inner_activations = 0;       ///< elements to hold besides input and output
    bool in_place = false;                   ///< can write over its input
    bool keeps_output = false;               ///< needs its output in the backward pass

    /// Adds the arrays and the work of another layer.
    constexpr void add(const layer_costs& other) {
        parameters += other.parameters;
        statistics += other.statistics;
        multiply_adds += other.multiply_adds;
        multiply_adds_on_pixels += other.multiply_adds_on_pixels;
    }
    friend constexpr bool operator==(const layer_costs&, const layer_costs&) = default;
};

/// An entry of a list of layers: a type with a name for its arrays, its costs, and a template `layer` that
/// binds it to a number type and an input shape.
template <class Spec>
concept layer_specification = requires(const shape& input) {
    { Spec::name } -> std::convertible_to<std::string_view>;
    { Spec::numbered } -> std::convertible_to<bool>;
    { Spec::costs(input) } -> std::same_as<layer_costs>;
    typename detail::template_of_layers<Spec::template layer>;
};

namespace detail {

/// Whether layer I of a list writes over its input: the list must own that, and its predecessor must not need
/// it in the backward pass.
template <std::size_t Size>
[[nodiscard]] constexpr std::array<bool, Size> overwriting(const std::array<layer_costs, Size>& layers) {
    std::array<bool, Size> result{};
    for (std::size_t i = 1; i < Size; ++i)
        result[i] = layers[i].in_place && !layers[i - 1].keeps_output;
    return result;
}

/// The costs of each specification in a list.
template <class... Specs>
[[nodiscard]] constexpr std::array<layer_costs, sizeof...(Specs)>
costs_of_each([[maybe_unused]] shape input) {
    std::array<layer_costs, sizeof...(Specs)> layers{};
    std::size_t i = 0;
    ((layers[i] = Specs::costs(input), input = layers[i].output, ++i), ...);
    return layers;
}

/// The costs of a list of layers as one layer. An empty list is the identity.
template <std::size_t Size>
[[nodiscard]] constexpr layer_costs costs_of_list(const shape& input,
                                                  const std::array<layer_costs, Size>& layers) {
    layer_costs list{.output = input};
    if constexpr (Size > 0) {
        const std::array<bool, Size> overwrites = overwriting(layers);
        // Layers from here on write to the caller's memory.
        std::size_t last = Size - 1;
        while (overwrites[last])
            --last;
        for (std::size_t i = 0; i < Size; ++i) {
            list.add(layers[i]);
            const std::size_t before = i == 0 ? 0 : list.output.size();
            const std::size_t after = i >= last || overwrites[i] ? 0 : layers[i].output.size();
            list.inner_activations =
                std::max(list.inner_activations, before + after + layers[i].inner_activations);
            list.output = layers[i].output;
        }
        list.keeps_output = layers[Size - 1].keeps_output;
    }
    return list;
}

/// The channels and arrays of the layers before a layer.
struct layer_offset {
    std::size_t channels = 0, parameters = 0, statistics = 0;
};
template <std::size_t Size>
[[nodiscard]] constexpr std::array<layer_offset, Size>
offsets_of(const std::array<layer_costs, Size>& layers) {
    std::array<layer_offset, Size> result{};
    for (std::size_t i = 1; i < Size; ++i)
        result[i] = {result[i - 1].channels + layers[i - 1].output.channels,
                     result[i - 1].parameters + layers[i - 1].parameters,
                     result[i - 1].statistics + layers[i - 1].statistics};
    return result;
}

/// Rejects a type that is no layer specification, and replaces it by the identity, so that no further errors
/// follow.
template <class Spec>
auto check_specification() {
    static_assert(layer_specification<Spec>,
                  "network: each entry of a list must be a layer specification, with name, numbered, "
                  "costs(const shape&) and a template layer<class, shape>; layer_specification shows what is "
                  "missing");
    return std::type_identity<sequence<>>{};
}
template <class Spec>
struct checked_specification : decltype(check_specification<Spec>()) {};
template <layer_specification Spec>
struct checked_specification<Spec> : std::type_identity<Spec> {};
template <class Spec>
using checked = typename checked_specification<Spec>::type;

} // namespace detail

// A list of layers holds specifications without sizes (`conv2d<8, 5>`). Bound to a number type and an input
// shape, a specification becomes a layer: constants, and names for its arrays. How it computes batches is
// described in trained_layer.hpp, what it becomes in a deployed network in lowering/lowering.hpp.

/// What an array of a network is for.
enum class parameter_role { weight, bias, scale, shift, slope, running_mean, running_variance };

/// Whether gradient descent changes the array; running statistics are not learnable.
[[nodiscard]] constexpr bool learnable(parameter_role r) {
    return r != parameter_role::running_mean && r != parameter_role::running_variance;
}

/// The elements of an array before training; weights are then drawn at random.
[[nodiscard]] constexpr double initial_value(parameter_role r) {
    return r == parameter_role::scale || r == parameter_role::running_variance ? 1
           : r == parameter_role::slope                                        ? 0.25
                                                                               : 0;
}

/// One array of a network. Its offset, in elements, is into the learnable parameters of the network or into
/// its statistics.
struct parameter : named_array {
    parameter_role role; ///< decides how initialisation and weight decay treat it
    std::size_t fan_in;  ///< inputs of one output, for initialisation
};

/// The constants of a layer, which are what `Spec::costs` returns. `Spec::layer<T, Input>` is this, or
/// derives from it and adds what else its training and its lowering need to know. A layer with parameters
/// hides `describe`.
template <class T, shape Input, class Spec>
struct layer_base {
private:
    static constexpr layer_costs own = Spec::costs(Input);

public:
    using value_type = T;
    static constexpr shape input = Input, output = own.output;
    static constexpr std::size_t parameters = own.parameters, statistics = own.statistics;
    static constexpr std::size_t multiply_adds = own.multiply_adds,
                                 multiply_adds_on_pixels = own.multiply_adds_on_pixels;
    static constexpr std::size_t inner_activations = own.inner_activations;
    static constexpr bool in_place = own.in_place, keeps_output = own.keeps_output;

    /// Appends the layer's arrays, with offsets from its first.
    static void describe(const std::string&, std::vector<parameter>&) {}
};

// Functions on the way to a layer's output shape (detail::…_output) reject what does not fit, not the layer
// itself: Clang takes no constants from a class with a failed assertion, and would bury the sentence under
// further errors.

/// Appends the array "prefix.name" to the layer's arrays. `flattened` is the input of a fully connected
/// layer, for its weights. Not inlined, to save compile time.
[[gnu::cold, gnu::noinline]] inline void
describe_array(std::vector<parameter>& list, const std::string& prefix, const char* name, parameter_role role,
               std::initializer_list<std::size_t> extents, std::size_t offset, std::size_t fan_in = 1,
               const shape& flattened = {0, 0, 0}) {
    std::string path(prefix); // appending compiles less than adding
    path.append(".", 1).append(name);
    parameter p{{std::move(path), extents, {}, offset, 0}, role, fan_in};
    p.size = detail::product_of(p.extents);
    if (flattened.size() > 0)
        p.flattened = {flattened.channels, flattened.rows, flattened.columns};
    list.push_back(std::move(p));
}

// Sequences of frames, for layers that run through time. A sequence has the shape {frames, 1, features}: a
// row for each frame, in the order of recording, and a channel for each feature. A sample lies feature by
// feature, as the input of PyTorch's Conv1d. `deploy_stream` runs such a network frame by frame
// (deployment/stream.hpp), so the number of frames matters for training alone.

/// Whether a shape can be that of a sequence.
template <std::size_t Columns>
concept one_column = Columns == 1;

/// A layer that needs a sequence, and that `deploy_stream` can run frame by frame.
template <class Spec>
concept layer_of_sequences = requires { requires Spec::takes_sequences; };

namespace detail {

/// Rejects inputs that are no sequence, and layers without outputs.
template <std::size_t Columns, std::size_t Outputs>
[[nodiscard]] constexpr shape sequence_output(shape output) {
    static_assert(
        one_column<Columns>,
        "sequence: the input must be a sequence {frames, 1, features}; one_column shows its columns");
    static_assert(Outputs > 0,
                  "sequence: a layer must have at least one output, one tap and a dilation of one");
    return output;
}

} // namespace detail

}} // namespace tactnet
