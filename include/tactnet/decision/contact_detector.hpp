#pragma once

#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// When something touches the array. Counts are of 8 bits, with their baseline subtracted. What is empty
/// follows from the array.
struct contact_settings {
    std::uint8_t pressed = 8; ///< the least count of a pressed tactel, above 0; `learn` may raise it
    std::uint8_t margin = 3;  ///< counts between the largest count of air and a pressed tactel
    float deviations = 5;     ///< of the noise of air, from 0, that a pressed tactel is above
    std::optional<std::uint16_t> begin_area{}; ///< tactels that begin a contact; empty: begin_area_of(array)
    std::optional<std::uint16_t> end_area{};   ///< tactels that end it, fewer; empty: half of begin_area
    std::uint8_t begin_frames = 2;             ///< frames in a row with begin_area or more, from 1
    std::uint8_t end_frames = 3;               ///< frames in a row with end_area or fewer, from 1

    /// The tactels that begin a contact: 12 of the 1400 of Gandarias et al. (2019) or of more, a share of as
    /// many of fewer, but 3, which noise hardly presses at once; 1 or 2 on arrays of fewer than 48 tactels.
    /// The smallest of their 1100 touches presses four times as many at 28 × 50, and 4 at 7 × 13.
    [[nodiscard]] static constexpr std::uint16_t begin_area_of(shape array) noexcept {
        const std::size_t least = std::clamp<std::size_t>(array.size() / 16, 1, 3);
        return static_cast<std::uint16_t>(std::clamp<std::size_t>(array.size() * 12 / 1400, least, 12));
    }
};

/// What the array feels.
struct contact_state {
    bool touching = false;
    bool began = false, ended = false; ///< with this frame
    /// The frame itself shows a touch, of begin_area or more: recognise it. False in the frames of air after
    /// a release in which `touching` still holds.
    bool firm = false;
    std::uint32_t area = 0;   ///< pressed tactels
    std::uint32_t force = 0;  ///< sum of their counts
    std::uint64_t frames = 0; ///< since the contact, or the air, began
};

/// Finds the beginning and the end of contacts, by two thresholds, so that noise near one of them does not
/// make many contacts of one. `Count` is the element of clean frames: std::uint8_t, or float on the same
/// scale.
template <shape Array, class Count = std::uint8_t>
class contact_detector {
public:
    using frame = std::span<const Count, Array.size()>;

    explicit contact_detector(const contact_settings& settings = {}) noexcept
        : settings_(settings),
          begin_area_(settings.begin_area.value_or(contact_settings::begin_area_of(Array))),
          end_area_(settings.end_area.value_or(static_cast<std::uint16_t>(begin_area_ / 2))),
          pressed_(std::max<std::uint8_t>(settings.pressed, 1)) {}

    /// Takes a clean frame of air, one of some 50. Tactels then count as pressed from `margin` above the
    /// largest count of air, and from `deviations` of its noise, which a few frames on a small array may not
    /// show at its largest.
    void learn(frame air) noexcept {
        std::conditional_t<std::is_integral_v<Count>, std::uint32_t, double> largest = 0, squares = 0;
        for (const Count count : air) {
            largest = std::max<decltype(largest)>(largest, count);
            squares += static_cast<decltype(squares)>(count) * count;
        }
        squares_ += static_cast<double>(squares);
        learnt_ += static_cast<double>(Array.size());
        // The baseline is subtracted: half of the noise is below it, and shows as 0.
        const double noise = std::sqrt(2 * squares_ / learnt_);
        const double least = std::max<double>(largest + settings_.margin, settings_.deviations * noise);
        pressed_ = std::max(pressed_, static_cast<std::uint8_t>(least < 255 ? std::ceil(least) : 255));
    }
    /// The least count of a pressed tactel.
    [[nodiscard]] std::uint8_t pressed() const noexcept { return pressed_; }

    /// Takes the next clean frame.
    const contact_state& update(frame clean) noexcept {
        const auto [area, force] = kernels::tally_pressed<Array.size()>(clean.data(), pressed_);
        const bool other = now_.touching ? area <= end_area_ : area >= begin_area_;
        others_ = other ? others_ + 1 : 0;
        const bool changes =
            others_ >= (now_.touching ? settings_.end_frames : settings_.begin_frames) && other;
        if (changes) {
            now_.touching = !now_.touching;
            now_.frames = others_ = 0;
        }
        now_.began = changes && now_.touching;
        now_.ended = changes && !now_.touching;
        now_.firm = now_.touching && area >= begin_area_;
        now_.area = area;
        now_.force = force;
        ++now_.frames;
        return now_;
    }
    [[nodiscard]] const contact_state& now() const noexcept { return now_; }

private:
    contact_settings settings_;
    std::uint16_t begin_area_, end_area_;
    std::uint8_t pressed_;
    double squares_ = 0, learnt_ = 0; ///< of the counts of air, and their number
    std::uint32_t others_ = 0;        ///< frames in a row that speak for the other state
    contact_state now_{};
};

}} // namespace tactnet
