#pragma once

#include <tactnet/deployment/stream_view.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

// How streams in 8 bits read the features of a frame and write their outputs.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Rounds features to words of 16 bits, each with a step of its own: its folded numbers. Finite features
/// beyond the words saturate.
template <class In, class Out, std::size_t Features>
struct stream_input<eight_bit_between<In, Out>, Features> {
    static constexpr std::size_t folded_elements = Features,
                                 packed_elements = pad_to_cache_line<std::int8_t>(4 * Features),
                                 map_elements = pad_to_cache_line<std::uint8_t>(2 * Features);

    /// Steps per unit.
    static constexpr void pack(const float* folded, std::int8_t* packed) {
        for (std::size_t f = 0; f < Features; ++f)
            detail::store_number(packed + 4 * f, 1 / folded[f]);
    }
    /// Whether all features are finite.
    static bool read(const std::int8_t* packed, std::span<const float, Features> frame,
                     std::uint8_t* in) noexcept {
        auto* const words = reinterpret_cast<std::int16_t*>(in);
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

/// Outputs of a last step that writes floats.
template <class In, class Out, std::size_t Outputs>
struct stream_output<eight_bit_between<In, Out>, float, Outputs> {
    static constexpr std::size_t folded_elements = 0, packed_elements = 0;

    static constexpr void pack(const float*, std::int8_t*) {}
    static void write(const std::int8_t*, const std::uint8_t* out, std::span<float, Outputs> to) noexcept {
        std::copy_n(reinterpret_cast<const float*>(out), Outputs, to.data());
    }
};
/// Outputs of a last step that writes whole numbers, bytes. The folded numbers are their range.
template <class In, class Out, class Number, std::size_t Outputs>
struct stream_output<eight_bit_between<In, Out>, Number, Outputs> {
    static constexpr std::size_t folded_elements = map_range::numbers,
                                 packed_elements = pad_to_cache_line<std::int8_t>(sizeof(map_range));

    static constexpr void pack(const float* folded, std::int8_t* packed) {
        for (std::size_t i = 0; i < map_range::numbers; ++i)
            detail::store_number(packed + 4 * i, folded[i]);
    }
    static void write(const std::int8_t* packed, const std::uint8_t* out,
                      std::span<float, Outputs> to) noexcept {
        const auto range = kernels::load_bytes_as<map_range>(packed);
        const auto* const numbers = reinterpret_cast<const Number*>(out);
        for (std::size_t o = 0; o < Outputs; ++o)
            to[o] = (static_cast<float>(numbers[o]) - range.zero_point) * range.scale;
    }
};

}} // namespace tactnet
