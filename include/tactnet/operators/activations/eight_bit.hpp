#pragma once

#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/activations/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// An elementwise activation in 8 bits: a clamp of bytes for a ReLU, otherwise a table with an output for
/// each byte.
template <class Function, shape Map, std::size_t Stride>
struct activation_step<eight_bit, Function, Map, Stride> : step_base<eight_bit, Map, Stride> {
    static constexpr bool clamps = detail::is_relu<Function>();
    /// A clamp keeps the range of its input.
    static constexpr folded_arrays arrays{range_of_input, !clamps ? range_of_output : folded_array{}};
    static constexpr std::size_t folded_elements = arrays.numbers();
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
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        using number = std::conditional_t<detail::works_on_vectors<Function>, double, float>;
        for (std::size_t e = 0; e < Map.size(); ++e)
            out[e] = static_cast<float>(Function::value(static_cast<number>(in[e])));
    }
};

/// A parametric ReLU in 8 bits: (byte − zero of the input) × factor, rounded once. The factor is that of the
/// ranges, below the zero times the slope of the channel.
template <shape Map, std::size_t Stride>
struct parametric_relu_step<eight_bit, Map, Stride> : step_base<eight_bit, Map, Stride> {
    static constexpr folded_arrays arrays{
        {"weight", folded_kind::numbers, {Map.channels}}, range_of_input, range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();

private:
    // The factors below zero, the one above, and the zeros of both maps.
    static constexpr std::size_t above = pad_to_cache_line<std::int8_t>(Stride * sizeof(float)),
                                 input_zero = above + sizeof(float), zero = input_zero + 1;

public:
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(zero + 1);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        const double factor = static_cast<double>(input.scale) / static_cast<double>(result.scale);
        for (std::size_t c = 0; c < Map.channels; ++c)
            detail::store_number(to + sizeof(float) * c,
                                 static_cast<float>(static_cast<double>(from[c]) * factor));
        detail::store_number(to + above, static_cast<float>(factor));
        detail::store_byte(to + input_zero, static_cast<double>(input.zero_point));
        detail::store_byte(to + zero, static_cast<double>(result.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        constexpr std::size_t width = std::min(kernels::widest_bytes(Stride), kernels::max_integer_lanes);
        using floats = kernels::float_vec<width>;
        const floats factor_above = kernels::load_bytes_as<float>(packed_values + above) - floats{};
        const std::int32_t zero_of_input = detail::load_byte(packed_values + input_zero);
        const kernels::byte_range range{0, 255, detail::load_byte(packed_values + zero)};
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; c += width) {
                const auto steps = kernels::instructions::to_int32<width>(
                                       kernels::load_bytes_as<kernels::uint8_vec<width>>(in + pixel + c)) -
                                   zero_of_input;
                const auto factor_below = kernels::load_bytes_as<floats>(packed_values + sizeof(float) * c);
                kernels::store_rounded<width>(out + pixel + c, steps, steps < 0 ? factor_below : factor_above,
                                              range);
            }
    }
    /// For calibration.
    static void reference(const float* slopes, const float* in, float* out) {
        for (std::size_t e = 0; e < Map.size(); ++e)
            out[e] = in[e] > 0 ? in[e] : slopes[e % Map.channels] * in[e];
    }
};

/// A square root in 8 bits, of the sensor's words or of bytes: √(x + offset) − √offset, and 0 for x < 0.
template <class Input, shape Map, std::size_t Stride, class Offset>
struct square_root_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Offset>
    : step_base<eight_bit, Map, Stride> {
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);
    static constexpr folded_arrays arrays{range_of_input, range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();

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
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        for (std::size_t e = 0; e < Map.size(); ++e)
            out[e] = static_cast<float>(std::sqrt(std::max(static_cast<double>(in[e]), 0.0) + offset) -
                                        std::sqrt(offset));
    }
};

}} // namespace tactnet
