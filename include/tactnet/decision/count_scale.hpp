#pragma once

#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

// Counts of any depth, as sensors give them, and the one scale of counts that networks, health and contact
// have: 0 without a touch, 255 at full scale.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The scale of a sensor's counts. For a 12-bit sensor: {.full = 4095}; for one whose counts fall from 2135
/// to 0:
/// {.untouched = 2135, .full = 0}.
struct count_scale {
    float untouched = 0; ///< the count without a touch
    float full = 255;    ///< the count at full scale, which becomes 255; another than `untouched`
    /// The count that marks a broken tactel. NaN and infinity always do.
    float broken = std::numeric_limits<float>::quiet_NaN();

    /// A count on the scale of 8 bits, from 0 on: 0 for less than no touch, above 255 beyond full scale; NaN
    /// of a broken tactel. Without a scale, `full` as `untouched`, it is 0.
    [[nodiscard]] float of(float count) const noexcept {
        if (!std::isfinite(count) || count == broken)
            return std::numeric_limits<float>::quiet_NaN();
        const float scaled = full == untouched ? 0 : (count - untouched) * (255 / (full - untouched));
        return scaled > 0 ? scaled : 0.0f;
    }
};

/// A frame of a sensor that someone else owns: std::uint8_t, std::uint16_t or float, row by row. Converts
/// from std::array, from a std::span of fixed size and from what converts to one.
template <shape Array>
class raw_counts {
    template <class Count>
    using frame = std::span<const Count, Array.size()>;

public:
    template <class Frame>
        requires(std::convertible_to<const Frame&, frame<std::uint8_t>> ||
                 std::convertible_to<const Frame&, frame<std::uint16_t>> ||
                 std::convertible_to<const Frame&, frame<float>>)
    raw_counts(const Frame& counts) noexcept : bytes_(sizeof(*std::begin(counts))) {
        if constexpr (std::convertible_to<const Frame&, frame<std::uint8_t>>)
            counts_ = frame<std::uint8_t>(counts).data();
        else if constexpr (std::convertible_to<const Frame&, frame<std::uint16_t>>)
            counts_ = frame<std::uint16_t>(counts).data();
        else
            counts_ = frame<float>(counts).data();
    }

    /// Writes the counts in 1/256 of an 8-bit count, up to 65535, and for each whether it marks a broken
    /// tactel: 1 or 0. Returns whether any does.
    bool quantise(const count_scale& scale, std::uint16_t* to, std::uint16_t* broken) const noexcept {
        switch (bytes_) {
        case 1:
            return kernels::quantise<Array.size()>(static_cast<const std::uint8_t*>(counts_), factor(scale),
                                                   scale.untouched, scale.broken, to, broken);
        case 2:
            return kernels::quantise<Array.size()>(static_cast<const std::uint16_t*>(counts_), factor(scale),
                                                   scale.untouched, scale.broken, to, broken);
        default:
            return kernels::quantise<Array.size()>(static_cast<const float*>(counts_), factor(scale),
                                                   scale.untouched, scale.broken, to, broken);
        }
    }

private:
    static float factor(const count_scale& scale) noexcept {
        return scale.full == scale.untouched ? 0 : 255 * 256 / (scale.full - scale.untouched);
    }

    const void* counts_ = nullptr;
    std::size_t bytes_; ///< of a count
};

}} // namespace tactnet
