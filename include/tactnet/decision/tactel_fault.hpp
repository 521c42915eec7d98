#pragma once

#include <tactnet/detail/config.hpp>

#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// How a tactel fails: it shows pressure where there is none, or none where there is pressure.
enum class tactel_fault_kind : std::uint8_t { stuck, dead };

/// A faulty tactel.
struct tactel_fault {
    std::uint16_t row = 0, column = 0;
    tactel_fault_kind kind{};
    std::uint64_t since = 0; ///< the frame in which it was found, counted from 0
};

/// When a frame shows that a tactel may be faulty. A spike is far above nearly all of its eight neighbours:
/// their counts are less than an eighth of its own. A hole has no pressure amid pressed neighbours. None of
/// the 1100 images of Gandarias et al. (2019) has a tactel within the default limits, since elastic skin and
/// the layers above the tactels blur every edge.
struct fault_limits {
    std::uint8_t spike = 100;  ///< the smallest count of a spike
    std::uint8_t hole = 2;     ///< the largest count of a hole
    std::uint8_t pressed = 60; ///< the smallest count of a pressed neighbour of a hole
    std::uint8_t neighbours =
        6; ///< how many neighbours are low or pressed; with 6, whole rows are found, too
};

/// How sensor_health judges tactels.
struct health_settings {
    fault_limits limits{};
    /// Frames with a spike or a hole that make a tactel faulty, from 1 to 127. A frame between them in which
    /// the tactel is seen to work starts the count again.
    std::uint8_t frames_to_fault = 16;
    /// Frames in which a faulty tactel is seen to work, from 1 to 255, after which it is used again. A frame
    /// between them in which it fails starts the count again.
    std::uint8_t frames_to_recovery = 200;
    /// A tactel whose counts of air are larger is stuck.
    std::uint8_t largest_baseline = 64;
    /// By how much the baseline follows a frame of air, in 1/256 count. The default is 0.4 counts per second
    /// at 100 frames per second.
    std::uint8_t follow = 1;
};

}} // namespace tactnet
