#pragma once

#include <tactnet/operators/layer.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <unsigned Percent>
[[nodiscard]] constexpr shape dropout_output(shape output) {
    static_assert(Percent < 100, "dropout: the percentage must be below 100");
    return output;
}

} // namespace detail

/// Dropout (Srivastava et al., 2014): training zeroes each element with the given probability in percent and
/// scales the others to keep the mean; inference changes nothing. The mask depends on the seed, the step, the
/// sample and the layer's place in the network alone.
template <unsigned Percent>
struct dropout {
    static constexpr std::string_view name = "dropout";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) { return {.output = input, .in_place = true}; }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, dropout> {
        static constexpr shape output = detail::dropout_output<Percent>(Input);
    };
};

}} // namespace tactnet
