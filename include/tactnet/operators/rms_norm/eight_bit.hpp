#pragma once

#include <tactnet/kernels/integer/norms.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/rms_norm/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A root mean square norm in 8 bits. The sum S of the squares of n distances q − zero is an exact integer. A
/// byte becomes (q − zero) · √(n ÷ (S + margin)) · weight, with the margin n · epsilon in steps of the input
/// and the weight in steps of the output. No product is added to anything, so all instruction sets give the
/// same bytes.
template <shape Map, std::size_t Stride>
struct rms_norm_step<eight_bit, Map, Stride> : step_base<eight_bit, Map, Stride> {
private:
    // Packed: the weights, the margin, then the zeros of both maps.
    static constexpr std::size_t margin = Stride * sizeof(float), zeros = margin + sizeof(float);
    static constexpr std::size_t width = std::min(kernels::widest_bytes(Stride), kernels::max_integer_lanes);
    using sums = kernels::detail::lane_sums<width>;
    static_assert(Map.channels <= sums::most, "rms_norm_step: in 8 bits a pixel has at most 32768 channels");

public:
    static constexpr folded_arrays arrays{{"weight", folded_kind::numbers, {Map.channels}},
                                          {"epsilon", folded_kind::positive_numbers, {1}},
                                          range_of_input,
                                          range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(zeros + 2);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        // `most` and `least` keep products and quotients finite.
        constexpr double most = 1e30, least = 1e-30, count = static_cast<double>(Map.channels);
        const auto step = static_cast<double>(input.scale);
        for (std::size_t c = 0; c < Map.channels; ++c) {
            const double weight = static_cast<double>(from[c]) / static_cast<double>(result.scale);
            detail::store_number(to + c * sizeof(float), static_cast<float>(std::clamp(weight, -most, most)));
        }
        const double epsilon = static_cast<double>(from[Map.channels]) * count / step / step;
        detail::store_number(to + margin, static_cast<float>(std::clamp(epsilon, least, most)));
        detail::store_byte(to + zeros, static_cast<double>(input.zero_point));
        detail::store_byte(to + zeros + 1, static_cast<double>(result.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        using floats = kernels::float_vec<width>;
        const std::int32_t zero = detail::load_byte(packed_values + zeros);
        const kernels::byte_range range{0, 255, detail::load_byte(packed_values + zeros + 1)};
        for (std::size_t e = 0; e < Map.area() * Stride; e += Stride) {
            const float inverse = std::sqrt(static_cast<float>(Map.channels) /
                                            (static_cast<float>(squares_of(in + e, zero)) +
                                             kernels::load_bytes_as<float>(packed_values + margin)));
            for (std::size_t c = 0; c < Stride; c += width) {
                const auto distances = kernels::instructions::to_int32<width>(
                                           kernels::load_bytes_as<kernels::uint8_vec<width>>(in + e + c)) -
                                       zero;
                kernels::store_rounded<width>(
                    out + e + c,
                    __builtin_convertvector(distances, floats) * inverse *
                        kernels::load_bytes_as<floats>(packed_values + c * sizeof(float)),
                    range);
            }
        }
    }
    /// For calibration.
    static void reference(const float* from, const float* in, float* out) {
        normalise_by_root_mean_square(Map, from, from[Map.channels], in, out);
    }

private:
    /// Σ (q − zero)² over the channels: lanes after the last hold anything.
    static std::int64_t squares_of(const std::uint8_t* in, std::int64_t zero) {
        constexpr std::size_t whole = Map.channels / width * width;
        sums some;
        for (std::size_t c = 0; c < whole; c += width)
            some.add(in + c);
        std::int64_t total = 0, squares = 0;
        for (std::size_t lane = 0; lane < width; ++lane)
            total += some.totals[lane], squares += some.squares[lane];
        for (std::size_t c = whole; c < Map.channels; ++c)
            total += in[c], squares += in[c] * in[c];
        return squares - 2 * zero * total + static_cast<std::int64_t>(Map.channels) * zero * zero;
    }
};

}} // namespace tactnet
