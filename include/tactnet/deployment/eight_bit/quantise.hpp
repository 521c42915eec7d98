#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

// From folded numbers to whole ones, usable when compiling.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// The nearest whole number, ties to the even one; magnitudes below 2⁶².
[[nodiscard]] constexpr std::int64_t nearest_even(double value) {
    auto whole = static_cast<std::int64_t>(value);
    const double rest = value - static_cast<double>(whole); // of the same sign as value
    if (rest > 0.5 || (rest == 0.5 && whole % 2 != 0))
        ++whole;
    if (rest < -0.5 || (rest == -0.5 && whole % 2 != 0))
        --whole;
    return whole;
}
[[nodiscard]] constexpr double magnitude(double value) {
    return value < 0 ? -value : value;
}

/// A number of four bytes among packed ones.
template <class Number>
constexpr void store_number(std::int8_t* to, Number value) {
    static_assert(sizeof(Number) == 4);
    const auto bytes = std::bit_cast<std::array<std::int8_t, 4>>(value);
    std::copy(bytes.begin(), bytes.end(), to);
}

/// How the sums of one filter stand for numbers: sum × unit. Weights are multiples of unit ÷ the input's
/// scale, at most 127 of them; the sum is at most 2³¹ − 1 for any input; where the step adds, a byte of the
/// other map counts a whole number of times.
struct filter_scale {
    double weight_scale = 1; ///< of one step of a weight
    double unit = 1;         ///< of one step of a sum
    std::int64_t added = 0;  ///< how often a byte of the other map counts
    std::int64_t start = 0;  ///< of the sum: bias, and what zeros that are not 0 make
};

/// For weights [count] and a bias. `largest_input` is the largest magnitude of a staged input, `offset` what
/// has been subtracted from it.
[[nodiscard]] constexpr filter_scale scale_filter(const float* weights, std::size_t count, double bias,
                                                  const step_ranges& ranges, bool adds, double largest_input,
                                                  int offset) {
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i)
        largest = std::max(largest, magnitude(static_cast<double>(weights[i])));
    const auto input_scale = static_cast<double>(ranges.input.scale);
    const auto added_scale = static_cast<double>(ranges.added.scale);
    filter_scale result;
    // Of a filter of zeros, the bias alone decides.
    const double of_bias = bias != 0 ? magnitude(bias) / 0x1p28 / input_scale : 1;
    result.weight_scale = largest > 0 ? largest / 127 : of_bias;
    for (;; result.weight_scale *= 2) {
        result.unit = result.weight_scale * input_scale;
        if (adds) {
            // A unit somewhat larger, so that the other map's step is a whole number of units: of a million
            // at most, beside which smaller weights add nothing. A step that is finer than a unit counts the
            // nearest number of times, 0 or 1.
            const auto times = static_cast<std::int64_t>(std::min(added_scale / result.unit, 1e6));
            result.added = times > 0 ? times : nearest_even(added_scale / result.unit);
            if (times > 0) {
                result.unit = added_scale / static_cast<double>(times);
                result.weight_scale = result.unit / input_scale;
            }
        }
        double of_magnitudes = 0;
        std::int64_t of_weights = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t weight = nearest_even(static_cast<double>(weights[i]) / result.weight_scale);
            of_magnitudes += magnitude(static_cast<double>(weight));
            of_weights += weight;
        }
        const double start_of_bias = bias / result.unit;
        const double most = of_magnitudes * largest_input + magnitude(start_of_bias) +
                            magnitude(static_cast<double>(of_weights)) * 383.0 +
                            255.0 * static_cast<double>(result.added);
        if (most < static_cast<double>(std::numeric_limits<std::int32_t>::max())) {
            const auto zero = static_cast<std::int64_t>(ranges.input.zero);
            const auto added_zero = static_cast<std::int64_t>(ranges.added.zero);
            result.start =
                nearest_even(start_of_bias) - (zero - offset) * of_weights - added_zero * result.added;
            return result;
        }
    }
}

[[nodiscard]] constexpr std::int8_t quantised(float weight, const filter_scale& scale) {
    const std::int64_t whole = nearest_even(static_cast<double>(weight) / scale.weight_scale);
    return static_cast<std::int8_t>(std::clamp<std::int64_t>(whole, -127, 127));
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
