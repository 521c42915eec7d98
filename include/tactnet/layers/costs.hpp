#pragma once

#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What a layer gives and costs for one sample. A specification tells it for an input of any size,
/// `Spec::costs(input)`, so that a table over many sizes makes no layer. An input that does not fit is
/// refused where the layer is made.
struct layer_costs {
    shape output;
    std::size_t parameters = 0;              ///< learnable: weights, biases, scales, shifts
    std::size_t statistics = 0;              ///< running means and variances
    std::size_t multiply_adds = 0;           ///< all taps
    std::size_t multiply_adds_on_pixels = 0; ///< without those on padding
    std::size_t inner_activations = 0;       ///< elements to hold beside input and output
    bool in_place = false;                   ///< may write over its input
    bool keeps_output = false;               ///< needs the output on the way back
    friend constexpr bool operator==(const layer_costs&, const layer_costs&) = default;
};

/// A specification that tells what its layer costs.
template <class Spec>
concept tells_costs = requires(const shape& input) {
    { Spec::costs(input) } -> std::same_as<layer_costs>;
};

/// Of a layer that is bound to its input.
template <class Layer>
inline constexpr layer_costs costs_of_layer{.output = Layer::output,
                                            .parameters = Layer::parameters,
                                            .statistics = Layer::statistics,
                                            .multiply_adds = Layer::multiply_adds,
                                            .multiply_adds_on_pixels = Layer::multiply_adds_on_pixels,
                                            .inner_activations = Layer::inner_activations,
                                            .in_place = Layer::in_place,
                                            .keeps_output = Layer::keeps_output};

namespace detail {

/// Whether layer I of a list may write over its input: it must be the list's own, and not needed behind it.
template <std::size_t Size>
[[nodiscard]] constexpr std::array<bool, Size> overwriting(const std::array<layer_costs, Size>& layers) {
    std::array<bool, Size> result{};
    for (std::size_t i = 1; i < Size; ++i)
        result[i] = layers[i].in_place && !layers[i - 1].keeps_output;
    return result;
}

/// Of layers one after the other, as one layer. Without any it passes its input on.
template <std::size_t Size>
[[nodiscard]] constexpr layer_costs costs_of_list(const shape& input,
                                                  const std::array<layer_costs, Size>& layers) {
    layer_costs list{.output = input};
    if constexpr (Size > 0) {
        const std::array<bool, Size> overwrites = overwriting(layers);
        // The layers from here on leave what they make in the caller's memory.
        std::size_t last = Size - 1;
        while (overwrites[last])
            --last;
        for (std::size_t i = 0; i < Size; ++i) {
            list.parameters += layers[i].parameters;
            list.statistics += layers[i].statistics;
            list.multiply_adds += layers[i].multiply_adds;
            list.multiply_adds_on_pixels += layers[i].multiply_adds_on_pixels;
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

/// Of specifications one after the other.
template <class... Specs>
[[nodiscard]] constexpr layer_costs costs_in_order(shape input) {
    static_assert((tells_costs<Specs> && ...),
                  "costs: each specification must tell what it costs for an input of "
                  "any size, costs(const shape&); tells_costs shows it");
    const shape first = input;
    std::array<layer_costs, sizeof...(Specs)> layers{};
    std::size_t i = 0;
    ((layers[i] = Specs::costs(input), input = layers[i].output, ++i), ...);
    return costs_of_list(first, layers);
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
