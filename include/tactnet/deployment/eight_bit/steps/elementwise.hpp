#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/eight_bit/quantise.hpp>
#include <tactnet/deployment/steps/elementwise.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// An elementwise activation in 8 bits: a clamp of bytes for a ReLU, otherwise a table with an output for
/// each byte.
template <class Function, shape Map, std::size_t Stride>
struct activation_step<eight_bit, Function, Map, Stride> : step_base<eight_bit, Map, Stride> {
    static constexpr bool clamps = detail::is_relu<Function>();
    /// A clamp keeps the range of its input.
    static constexpr folded_arrays arrays{range_array("input"), range_array("output", !clamps)};
    static constexpr std::size_t folded_elements = arrays.numbers(), ranges = arrays.ranges();
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(clamps ? 1 : 256);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        if constexpr (clamps) {
            detail::store_byte(to, static_cast<double>(input.zero_point));
        } else {
            for (int byte = 0; byte < 256; ++byte) {
                const double value = Function::value((byte - static_cast<double>(input.zero_point)) *
                                                     static_cast<double>(input.scale));
                // What is not a number counts as zero.
                const double steps =
                    value == value ? std::clamp(value / static_cast<double>(result.scale), -512.0, 512.0) : 0;
                detail::store_byte(to + byte, std::clamp(static_cast<double>(detail::nearest_even(steps)) +
                                                             static_cast<double>(result.zero_point),
                                                         0.0, 255.0));
            }
        }
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        for (std::size_t e = 0; e < Map.area() * Stride; ++e)
            if constexpr (clamps)
                out[e] = std::max(in[e], detail::load_byte(packed_values));
            else
                out[e] = detail::load_byte(packed_values + in[e]);
    }
};

template <class Function, shape Map, std::size_t Stride>
struct activation_step<eight_bit::input_format, Function, Map, Stride>
    : activation_step<eight_bit, Function, Map, Stride>, detail::cannot_read_the_frame<Stride> {};

/// A separate batch norm in 8 bits, with or without ReLU: a weight of 16 bits per channel.
template <class Input, shape Map, std::size_t Stride, bool Rectified>
struct norm_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Rectified>
    : step_base<eight_bit, Map, Stride> {
    static constexpr folded_arrays arrays{{"weight", folded_kind::numbers, {Map.channels}},
                                          {"bias", folded_kind::numbers, {Map.channels}},
                                          range_array("input"),
                                          range_array("output")};
    static constexpr std::size_t folded_elements = arrays.numbers(), ranges = arrays.ranges();

private:
    static constexpr std::size_t of_channels = pad_to_cache_line<std::int8_t>(Stride * sizeof(std::int32_t));
    static constexpr std::size_t starts = of_channels, factors = starts + of_channels,
                                 bytes = factors + of_channels;
    static constexpr std::size_t lowest = 0, zero = 1;

public:
    static constexpr std::size_t packed_elements = bytes + pad_to_cache_line<std::int8_t>(2);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        for (std::size_t c = 0; c < Map.channels; ++c) {
            const auto weight = static_cast<double>(from[c]);
            const auto offset = static_cast<double>(from[Map.channels + c]);
            const double unit = detail::norm_unit(from[c], from[Map.channels + c], input);
            const std::int64_t times = detail::nearest_even(weight * static_cast<double>(input.scale) / unit);
            const std::int64_t start =
                detail::nearest_even(offset / unit) - times * static_cast<std::int64_t>(input.zero_point);
            detail::store_number(to + 4 * c, static_cast<std::int32_t>(times));
            detail::store_number(to + starts + 4 * c, static_cast<std::int32_t>(start));
            detail::store_number(to + factors + 4 * c,
                                 static_cast<float>(unit / static_cast<double>(result.scale)));
        }
        const auto zero_byte = static_cast<double>(result.zero_point);
        detail::store_byte(to + bytes + lowest, Rectified ? zero_byte : 0);
        detail::store_byte(to + bytes + zero, zero_byte);
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const kernels::byte_range range{detail::load_byte(packed_values + bytes + lowest), 255,
                                        detail::load_byte(packed_values + bytes + zero)};
        const auto* const from = reinterpret_cast<const Input*>(in);
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; ++c) {
                const auto times = kernels::load_bytes_as<std::int32_t>(packed_values + 4 * c),
                           start = kernels::load_bytes_as<std::int32_t>(packed_values + starts + 4 * c);
                kernels::store_rounded<1>(
                    out + pixel + c, kernels::int32_vec<1>{from[pixel + c] * times + start},
                    kernels::load_bytes_as<kernels::float_vec<1>>(packed_values + factors + 4 * c), range);
            }
    }
};

/// A square root in 8 bits, of the sensor's words or of bytes: √(x + offset) − √offset, and 0 for x < 0.
template <class Input, shape Map, std::size_t Stride, class Offset>
struct square_root_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Offset>
    : step_base<eight_bit, Map, Stride> {
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);
    static constexpr folded_arrays arrays{range_array("input"), range_array("output")};
    static constexpr std::size_t folded_elements = arrays.numbers(), ranges = arrays.ranges();

private:
    // The offset in steps of the input, 1/1024 in steps of the output, the step of the input; then two bytes.
    static constexpr std::size_t of_offset = 0, of_part = of_offset + sizeof(float),
                                 of_step = of_part + sizeof(float), bytes = of_step + sizeof(float);

public:
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(bytes + 2);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        detail::store_number(to + of_offset, static_cast<float>(offset / static_cast<double>(input.scale)));
        detail::store_number(to + of_part,
                             static_cast<float>(1 / 1024.0 / static_cast<double>(result.scale)));
        detail::store_number(to + of_step, input.scale);
        detail::store_byte(to + bytes, static_cast<double>(input.zero_point));
        detail::store_byte(to + bytes + 1, static_cast<double>(result.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const std::uint8_t input_zero = detail::load_byte(packed_values + bytes),
                           zero = detail::load_byte(packed_values + bytes + 1);
        // √(n · step + offset) = √step · √(n + offset ÷ step)
        const float factor = std::sqrt(kernels::load_bytes_as<float>(packed_values + of_step)) *
                             kernels::load_bytes_as<float>(packed_values + of_part);
        kernels::roots_to_bytes(reinterpret_cast<const Input*>(in), Map.area() * Stride, input_zero,
                                kernels::load_bytes_as<float>(packed_values + of_offset), factor,
                                {zero, 255, zero}, out);
    }
};

}} // namespace tactnet
