#pragma once

#include <tactnet/detail/config.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The frames before the present one that a causal convolution looks back to, zero at first, in a ring.
template <class Number, std::size_t Features, std::size_t Taps, std::size_t Dilation>
struct frame_ring {
    static constexpr std::size_t frames = (Taps - 1) * Dilation;
    std::array<Number, frames * Features> elements{};
    std::uint32_t next = 0; ///< the oldest, below `frames`

    /// `next`, of whatever bytes: a caller may have filled the state with damaged ones.
    [[nodiscard]] std::size_t oldest() const noexcept { return next < frames ? next : 0; }

    /// The features of the frame (Taps − 1 − tap) · Dilation before the present one, for all taps but the
    /// last.
    [[nodiscard]] const Number* before(std::size_t tap) const noexcept {
        std::size_t frame = oldest() + tap * Dilation; // this far after the oldest
        if (frame >= frames)
            frame -= frames;
        return elements.data() + frame * Features;
    }
    /// Where the features of the present frame take the place of the oldest. Call it once for each frame.
    [[nodiscard]] Number* replace_oldest() noexcept {
        const std::size_t place = oldest();
        next = static_cast<std::uint32_t>(place + 1 == frames ? 0 : place + 1);
        return elements.data() + place * Features;
    }
};
/// One tap looks back to nothing.
template <class Number, std::size_t Features, std::size_t Dilation>
struct frame_ring<Number, Features, 1, Dilation> {};

}}} // namespace tactnet::detail
