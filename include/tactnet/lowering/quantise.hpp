#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

// Rounds folded numbers to integers, also when compiling.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The nearest integer, ties to even; magnitudes below 2⁶².
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

/// Writes a number of four bytes to packed numbers.
template <class Number>
constexpr void store_number(std::int8_t* to, Number value) {
    static_assert(sizeof(Number) == 4);
    const auto bytes = detail::bits_as<std::array<std::int8_t, 4>>(value);
    std::copy(bytes.begin(), bytes.end(), to);
}

/// An integer from 0 to 255 among packed ones, as a byte without a sign.
constexpr void store_byte(std::int8_t* to, double value) {
    *to = static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
}
[[nodiscard]] constexpr std::uint8_t load_byte(const std::int8_t* from) {
    return static_cast<std::uint8_t>(*from);
}

/// The scale of one filter: a sum stands for sum × unit. Weights are whole multiples of their scale, at most
/// ±127; where the step adds, a byte of the other map counts a whole number of times.
struct filter_scale {
    double weight_scale = 1; ///< the step of the weights
    double unit = 1;         ///< the step of the sums
    std::int64_t added = 0;  ///< the factor of a byte of the other map
    std::int64_t start = 0;  ///< of the sum: the bias, and a correction for zeros that are not 0
    double max_abs_sum = 0;  ///< the largest magnitude of a sum, and of all partial sums

    [[nodiscard]] constexpr bool fits() const {
        return max_abs_sum < static_cast<double>(std::numeric_limits<std::int32_t>::max());
    }
};

/// A weight in steps of its scale; it saturates to ±127.
[[nodiscard]] constexpr std::int8_t quantised(float weight, double weight_scale) {
    return static_cast<std::int8_t>(
        nearest_even(std::clamp(static_cast<double>(weight) / weight_scale, -127.0, 127.0)));
}
[[nodiscard]] constexpr std::int8_t quantised(float weight, const filter_scale& scale) {
    return quantised(weight, scale.weight_scale);
}
/// The nearest weight of 8 bits.
[[nodiscard]] constexpr float rounded_weight(float weight, float scale) {
    return static_cast<float>(quantised(weight, static_cast<double>(scale))) * scale;
}

/// The scale of a filter of weights [count] and a bias, with steps of `weight_scale`. `largest_input` is the
/// largest magnitude of a staged input, from which `offset` has been subtracted. All positive scales give
/// numbers; the caller checks whether sums fit into 32 bits.
[[nodiscard]] [[gnu::noinline]] constexpr filter_scale filter_of(const float* weights, std::size_t count,
                                                                 double bias, float weight_scale,
                                                                 const step_ranges& ranges, bool accumulates,
                                                                 double largest_input, int offset) {
    // Nothing larger fits, and integers of 64 bits still hold it.
    const auto whole = [](double value) { return nearest_even(std::clamp(value, -0x1p40, 0x1p40)); };
    filter_scale result;
    result.weight_scale = static_cast<double>(weight_scale);
    result.unit = result.weight_scale * static_cast<double>(ranges.input.scale);
    if (accumulates) // 0 or 1 for a step that is finer than a unit
        result.added = whole(static_cast<double>(ranges.added.scale) / result.unit);
    double of_magnitudes = 0;
    std::int64_t of_weights = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t weight = quantised(weights[i], result.weight_scale);
        of_magnitudes += magnitude(static_cast<double>(weight));
        of_weights += weight;
    }
    const double start_of_bias = bias / result.unit;
    result.max_abs_sum = of_magnitudes * largest_input + magnitude(start_of_bias) +
                         magnitude(static_cast<double>(of_weights)) * 383.0 +
                         255.0 * static_cast<double>(result.added);
    const auto zero = static_cast<std::int64_t>(ranges.input.zero_point);
    const auto added_zero = static_cast<std::int64_t>(ranges.added.zero_point);
    result.start = whole(start_of_bias) - (zero - offset) * of_weights - added_zero * result.added;
    return result;
}

/// The scale of a filter's weights: the largest weight is 127 steps, unless a sum might then overflow 32
/// bits. Where the step adds, the other map's step is a whole number of units. If nothing fits, the last
/// scale tried.
[[nodiscard]] [[gnu::noinline]] constexpr float scale_of_filter(const float* weights, std::size_t count,
                                                                double bias, const step_ranges& ranges,
                                                                bool accumulates, double largest_input) {
    // Scales are normal numbers in single precision, so that files can hold them.
    constexpr double least = static_cast<double>(std::numeric_limits<float>::min()), most = 0x1p99;
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i)
        largest = std::max(largest, magnitude(static_cast<double>(weights[i])));
    const auto input_scale = static_cast<double>(ranges.input.scale);
    const auto added_scale = static_cast<double>(ranges.added.scale);
    // In a filter of zeros, the bias alone decides.
    const double of_bias = bias != 0 ? magnitude(bias) / 0x1p28 / input_scale : 1;
    double wanted = largest > 0 ? largest / 127 : of_bias;
    while (true) {
        wanted = std::clamp(wanted, least, most);
        if (accumulates) {
            // Slightly larger, so that the other map's step is a whole number of units: at most a million,
            // next to which smaller weights do not count.
            const auto times = static_cast<std::int64_t>(std::min(added_scale / (wanted * input_scale), 1e6));
            if (times > 0)
                wanted = std::clamp(added_scale / static_cast<double>(times) / input_scale, least, most);
        }
        const auto scale = static_cast<float>(wanted);
        if (!(wanted < most) || !(input_scale > 0) ||
            filter_of(weights, count, bias, scale, ranges, accumulates, largest_input, 0).fits())
            return scale;
        wanted *= 2;
    }
}

/// The step of the sums of a batch norm: 15 bits for the weight, fewer if the offset is so large that the sum
/// would exceed 31 bits.
[[nodiscard]] constexpr double norm_unit(float weight, float offset, const map_range& input) {
    const double unit =
        std::max(magnitude(static_cast<double>(weight)) / 32767 * static_cast<double>(input.scale),
                 magnitude(static_cast<double>(offset)) / 0x1p29);
    return unit > 0 ? unit : 1;
}

}}} // namespace tactnet::detail
