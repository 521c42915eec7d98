#pragma once

#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <ratio>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// y = √(x + offset) − √offset, and 0 for x below 0. As the first layer of a network of counts it stabilises
/// their variance: counts are noisier the larger they are, and the noise of their root is nearly constant
/// (Anscombe, "The transformation of Poisson, binomial and negative-binomial data", 1948, with an offset of ⅜
/// of a count). Zero stays zero. `Offset` is a fraction (std::ratio) above zero in units of the input; the
/// default is ⅜ of a count of 8 bits divided by 255. In place.
template <class Offset = std::ratio<3, 8 * 255>>
struct square_root {
    static constexpr std::string_view name = "square_root";
    static constexpr bool numbered = true;
    static constexpr bool takes_counts =
        true; ///< inputs below 0, as after subtracting a mean image, would be lost
    static_assert(std::ratio_greater_v<Offset, std::ratio<0>>, "square_root: the offset must be above zero");
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    using layer = layer_base<T, Input, square_root>;
};

}} // namespace tactnet
