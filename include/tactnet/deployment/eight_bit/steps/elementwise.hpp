#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/eight_bit/quantise.hpp>
#include <tactnet/deployment/steps/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// An elementwise activation in 8 bits: a clamp of bytes where it clamps below zero, otherwise a table with
/// an output for each byte.
template <class Function, shape Map, std::size_t Stride>
struct activation_step<eight_bit, Function, Map, Stride> {
    using format = eight_bit;
    static constexpr shape output = Map;
    static constexpr std::size_t output_stride = Stride;
    static constexpr bool clamps = detail::clamps_below_zero<Function>;
    static constexpr std::size_t ranges = clamps ? 1 : 2; ///< a clamp keeps the range of its input
    static constexpr folded_arrays arrays{range_array("input"), range_array("output", !clamps)};
    static constexpr std::size_t folded = arrays.numbers(), workspace_elements = 0;
    static constexpr std::size_t packed = whole_lines<std::int8_t>(clamps ? 1 : 256);

    static constexpr void set_ranges(float* to, const step_ranges& values) {
        values.input.write(to);
        if constexpr (!clamps)
            values.output.write(to + map_range::numbers);
    }
    static constexpr void pack(const float* from, std::int8_t* to) {
        const map_range input = map_range::read(from);
        const auto as_byte = [](double value) {
            return static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
        };
        if constexpr (clamps) {
            *to = as_byte(static_cast<double>(input.zero));
        } else {
            const map_range result = map_range::read(from + map_range::numbers);
            for (int byte = 0; byte < 256; ++byte) {
                const double value = Function::value((byte - static_cast<double>(input.zero)) *
                                                     static_cast<double>(input.scale));
                const double steps = std::clamp(value / static_cast<double>(result.scale), -512.0, 512.0);
                to[byte] = as_byte(std::clamp(static_cast<double>(detail::nearest_even(steps)) +
                                                  static_cast<double>(result.zero),
                                              0.0, 255.0));
            }
        }
    }
    static double output_bound(const float*, double input) {
        return activation_step<single_precision, Function, Map, Stride>::output_bound(nullptr, input);
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        for (std::size_t e = 0; e < Map.area() * Stride; ++e)
            if constexpr (clamps)
                out[e] = std::max(in[e], static_cast<std::uint8_t>(*packed_values));
            else
                out[e] = static_cast<std::uint8_t>(packed_values[in[e]]);
    }
};

/// A batch norm by itself in 8 bits, with or without ReLU: one weight of 16 bits for each channel.
template <class Input, shape Map, std::size_t Stride, bool Rectified>
struct norm_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Rectified> {
    using format = eight_bit;
    static constexpr shape output = Map;
    static constexpr std::size_t output_stride = Stride;
    static constexpr std::size_t ranges = 2;
    static constexpr folded_arrays arrays{{"weight", folded_kind::numbers, {Map.channels}},
                                          {"bias", folded_kind::numbers, {Map.channels}},
                                          range_array("input"),
                                          range_array("output")};
    static constexpr std::size_t folded = arrays.numbers();

private:
    static constexpr std::size_t of_channels = whole_lines<std::int8_t>(Stride * sizeof(std::int32_t));
    static constexpr std::size_t starts = of_channels, factors = starts + of_channels,
                                 bytes = factors + of_channels;
    static constexpr std::size_t lowest = 0, zero = 1;

public:
    static constexpr std::size_t packed = bytes + whole_lines<std::int8_t>(2), workspace_elements = 0;

    static constexpr void set_ranges(float* to, const step_ranges& values) {
        values.input.write(to + 2 * Map.channels);
        values.output.write(to + 2 * Map.channels + map_range::numbers);
    }
    static constexpr void pack(const float* from, std::int8_t* to) {
        const map_range input = map_range::read(from + 2 * Map.channels),
                        result = map_range::read(from + 2 * Map.channels + map_range::numbers);
        for (std::size_t c = 0; c < Map.channels; ++c) {
            const auto weight = static_cast<double>(from[c]);
            const auto offset = static_cast<double>(from[Map.channels + c]);
            const double unit = detail::norm_unit(from[c], from[Map.channels + c], input);
            const std::int64_t times = detail::nearest_even(weight * static_cast<double>(input.scale) / unit);
            const std::int64_t start =
                detail::nearest_even(offset / unit) - times * static_cast<std::int64_t>(input.zero);
            detail::store_number(to + 4 * c, static_cast<std::int32_t>(times));
            detail::store_number(to + starts + 4 * c, static_cast<std::int32_t>(start));
            detail::store_number(to + factors + 4 * c,
                                 static_cast<float>(unit / static_cast<double>(result.scale)));
        }
        const auto as_byte = [](float value) {
            return static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
        };
        to[bytes + lowest] = Rectified ? as_byte(result.zero) : std::int8_t{0};
        to[bytes + zero] = as_byte(result.zero);
    }
    static double output_bound(const float* from, double input) {
        return detail::largest_sum(from, Map.channels, 1, input);
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const auto byte = [&](std::size_t which) {
            return static_cast<std::uint8_t>(packed_values[bytes + which]);
        };
        const kernels::byte_range range{byte(lowest), 255, byte(zero)};
        const auto* const from = reinterpret_cast<const Input*>(in);
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; ++c) {
                const auto times = kernels::load_any<std::int32_t>(packed_values + 4 * c),
                           start = kernels::load_any<std::int32_t>(packed_values + starts + 4 * c);
                kernels::store_rounded<1>(
                    out + pixel + c, kernels::int32_vec<1>{from[pixel + c] * times + start},
                    kernels::load_any<kernels::float_vec<1>>(packed_values + factors + 4 * c), range);
            }
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
