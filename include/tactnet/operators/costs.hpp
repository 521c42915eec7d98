#pragma once

#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <string_view>
#include <type_traits>

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
}} // namespace tactnet
