#pragma once

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/eight_bit.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
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

/// Rounds the features of a stream to words of 16 bits, each with a step of its own: its folded numbers.
/// Finite features beyond the words saturate.
template <std::size_t Features, std::size_t States>
struct stream_input_stage<eight_bit, Features, States> {
    /// The value of one step of a feature's words, of which the first layer reads whole numbers.
    static constexpr folded_arrays arrays{{"step", folded_kind::scales, {Features}}};
    static constexpr std::size_t folded_elements = Features,
                                 packed_elements = pad_to_cache_line<std::int8_t>(4 * Features),
                                 map = pad_to_cache_line<std::uint8_t>(2 * Features);

    /// Steps per unit.
    static constexpr void pack(const float* folded, std::int8_t* packed) {
        for (std::size_t f = 0; f < Features; ++f)
            detail::store_number(packed + 4 * f, 1 / folded[f]);
    }
    /// Any numbers of a state give finite outputs.
    static double largest_in_state(const std::int8_t*, std::size_t) noexcept {
        return std::numeric_limits<double>::infinity();
    }
    /// Whether all features are finite.
    static bool read(const std::int8_t* packed, std::span<const float, Features> frame,
                     std::uint8_t* in) noexcept {
        auto* const words = reinterpret_cast<std::int16_t*>(in);
        std::fill(words + Features, words + detail::round_up(Features, 4), std::int16_t{0});
        std::size_t broken = 0;
        for (std::size_t f = 0; f < Features; ++f) {
            constexpr float limit = std::numeric_limits<std::int16_t>::max();
            broken += !(std::abs(frame[f]) <= std::numeric_limits<float>::max());
            // The clamp lies between the product and the sum that rounds it.
            const auto steps_per_unit = kernels::load_bytes_as<float>(packed + 4 * f);
            const float scaled = std::clamp(frame[f] * steps_per_unit, -limit, limit);
            words[f] = static_cast<std::int16_t>(kernels::nearest<1>(kernels::float_vec<1>{scaled})[0]);
        }
        return broken == 0;
    }
};

/// Writes the floats of the last step to outputs [channel][row][column].
template <shape Output, std::size_t Stride>
struct output_stage<eight_bit, Output, Stride> {
    static bool write(const std::uint8_t* out, std::span<float, Output.size()> to) noexcept {
        return output_stage<single_precision, Output, Stride>::write(reinterpret_cast<const float*>(out), to);
    }
};

}} // namespace tactnet
