#pragma once

#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// When something touches the array. The defaults are for counts of 8 bits whose baseline is subtracted: the
/// smallest touch among the 1100 images of Gandarias et al. (2019) has 48 tactels of 8 counts or more.
struct contact_settings {
    std::uint8_t pressed = 8;      ///< the least count of a pressed tactel, above 0; `learn` may raise it
    std::uint8_t margin = 3;       ///< counts between the largest count of air and a pressed tactel
    std::uint16_t begin_area = 12; ///< tactels that begin a contact
    std::uint16_t end_area = 6;    ///< tactels that end it, fewer than begin_area
    std::uint8_t begin_frames = 2; ///< frames in a row with begin_area or more, from 1
    std::uint8_t end_frames = 3;   ///< frames in a row with end_area or fewer, from 1
};

/// What the array feels.
struct contact_state {
    bool touching = false;
    bool began = false, ended = false; ///< with this frame
    std::uint32_t area = 0;            ///< pressed tactels
    std::uint32_t force = 0;           ///< sum of their counts
    std::uint64_t frames = 0;          ///< since the contact, or the air, began
};

/// Finds the beginning and the end of contacts, by two thresholds, so that noise near one of them does not
/// make many contacts of one.
template <shape Array>
class contact_detector {
public:
    using frame = std::span<const std::uint8_t, Array.size()>;

    explicit contact_detector(const contact_settings& settings = {}) noexcept
        : settings_(settings), pressed_(std::max<std::uint8_t>(settings.pressed, 1)) {}

    /// Takes a clean frame of air: tactels then count as pressed from `margin` above its largest count.
    void learn(frame air) noexcept {
        std::uint8_t largest = 0;
        for (std::size_t i = 0; i < Array.size(); ++i)
            largest = std::max(largest, air[i]);
        pressed_ = std::max(pressed_, static_cast<std::uint8_t>(std::min(255, largest + settings_.margin)));
    }
    /// The least count of a pressed tactel.
    [[nodiscard]] std::uint8_t pressed() const noexcept { return pressed_; }

    /// Takes the next clean frame.
    const contact_state& update(frame clean) noexcept {
        const auto [area, force] = kernels::tally_pressed<Array.size()>(clean.data(), pressed_);
        const bool other = now_.touching ? area <= settings_.end_area : area >= settings_.begin_area;
        others_ = other ? others_ + 1 : 0;
        const bool changes =
            others_ >= (now_.touching ? settings_.end_frames : settings_.begin_frames) && other;
        if (changes) {
            now_.touching = !now_.touching;
            now_.frames = others_ = 0;
        }
        now_.began = changes && now_.touching;
        now_.ended = changes && !now_.touching;
        now_.area = area;
        now_.force = force;
        ++now_.frames;
        return now_;
    }
    [[nodiscard]] const contact_state& now() const noexcept { return now_; }

private:
    contact_settings settings_;
    std::uint8_t pressed_;
    std::uint32_t others_ = 0; ///< frames in a row that speak for the other state
    contact_state now_{};
};

}} // namespace tactnet
