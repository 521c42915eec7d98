#pragma once

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/eight_bit.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// What a deployed network in 8 bits runs: how it reads a frame and writes its outputs, here, and its steps.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Converts counts to words of 16 bits, pixel by pixel: counts × steps − mean × steps, both rounded, so that
/// counts of 8 bits keep every bit and the mean 1/256 of a count. Folded numbers: the mean frame, the steps
/// per count (a power of two), the largest |count − mean| that words hold.
template <shape Input>
struct input_stage<eight_bit, Input> {
    static constexpr std::size_t folded_elements = Input.size() + 2;
    static constexpr std::size_t map = pad_to_cache_line<std::uint8_t>(Input.size() * sizeof(std::int16_t));
    static constexpr std::size_t packed_elements = map + pad_to_cache_line<std::int8_t>(2 * sizeof(float));

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto steps = static_cast<double>(from[Input.size()]);
        for (std::size_t e = 0; e < Input.size(); ++e) {
            const auto bytes = detail::bits_as<std::array<std::int8_t, 2>>(
                static_cast<std::int16_t>(detail::nearest_even(static_cast<double>(from[e]) * steps)));
            to[2 * e] = bytes[0], to[2 * e + 1] = bytes[1];
        }
        detail::store_number(to + map, from[Input.size()]);
        detail::store_number(to + map + sizeof(float), from[Input.size() + 1]);
    }
    /// Returns whether the whole frame is finite and fits into words.
    template <class Count>
    static bool read(const std::int8_t* packed_values, const Count* counts, std::uint8_t* in) noexcept {
        const auto* const mean = reinterpret_cast<const std::int16_t*>(packed_values);
        const auto limits = kernels::load_bytes_as<std::array<float, 2>>(packed_values + map);
        const float steps = limits[0], most = limits[1] * steps;
        auto* const words = reinterpret_cast<std::int16_t*>(in);
        if constexpr (Input.channels == 1) {
            return kernels::counts_to_words(counts, Input.size(), mean, steps, most, words);
        } else {
            constexpr std::size_t most_pixels = 64;
            std::array<std::int16_t, most_pixels> some;
            bool fits = true;
            for (std::size_t channel = 0; channel < Input.channels; ++channel)
                for (std::size_t first = 0; first < Input.area(); first += most_pixels) {
                    const std::size_t at = channel * Input.area() + first,
                                      pixels = std::min(most_pixels, Input.area() - first);
                    fits &=
                        kernels::counts_to_words(counts + at, pixels, mean + at, steps, most, some.data());
                    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
                        words[(first + pixel) * Input.channels + channel] = some[pixel];
                }
            return fits;
        }
    }
};

/// Writes the floats of the last step to outputs [channel][row][column].
template <shape Output, std::size_t Stride>
struct output_stage<eight_bit, Output, Stride> {
    static constexpr std::size_t map =
        pad_to_cache_line<std::uint8_t>(Output.area() * Stride * sizeof(float));
    static bool write(const std::uint8_t* out, std::span<float, Output.size()> to) noexcept {
        return output_stage<single_precision, Output, Stride>::write(reinterpret_cast<const float*>(out), to);
    }
};

}} // namespace tactnet
