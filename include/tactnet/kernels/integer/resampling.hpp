#pragma once

#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Resamples a frame of bytes (kernels/sampling_axis.hpp): Σ (byte − zero) · parts down · parts along, a sum
/// of integers, × 1 ÷ both denominators in single precision, rounded to the nearest integer, ties to even,
/// plus the zero. `Stride` bytes from one pixel to the next, in both maps.
template <class Down, class Along, std::size_t Stride>
void resample_bytes(const std::uint8_t* input, std::uint8_t zero, std::uint8_t* output) {
    constexpr std::size_t width = std::min(widest_bytes(Stride), max_integer_lanes);
    constexpr std::size_t parts = Down::denominator * Along::denominator;
    static_assert(parts <= std::size_t{1} << 23, "resample_bytes: sums must fit into 32 bits");
    constexpr float share = 1 / static_cast<float>(parts);
    const float_vec<width> factors = share - float_vec<width>{};
    const int32_vec<width> start = int32_vec<width>{} - static_cast<std::int32_t>(parts) * zero;
    const byte_range range{0, 255, zero};
    for (const auto& above : Down::table)
        for (const auto& beside : Along::table) {
            const std::uint8_t* const from = input + (above.first * Along::inputs + beside.first) * Stride;
            for (std::size_t channel = 0; channel < Stride; channel += width) {
                int32_vec<width> sum = start;
                for (std::size_t y = 0; y < Down::taps; ++y)
                    for (std::size_t x = 0; x < Along::taps; ++x)
                        sum += instructions::to_int32<width>(load_bytes_as<uint8_vec<width>>(
                                   from + (y * Along::inputs + x) * Stride + channel)) *
                               (above.parts[y] * beside.parts[x]);
                store_rounded<width>(output + channel, sum, factors, range);
            }
            output += Stride;
        }
}

}}} // namespace tactnet::kernels
