#pragma once

#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/parametric_relu/step.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

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

template <shape Map, std::size_t Stride>
struct parametric_relu_step<eight_bit::input_format, Map, Stride>
    : parametric_relu_step<eight_bit, Map, Stride>, detail::cannot_read_the_frame<Stride> {};

}} // namespace tactnet
