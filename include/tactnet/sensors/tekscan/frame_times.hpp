#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/sensors/tekscan/text.hpp>

#include <cmath>
#include <cstdint>
#include <optional>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// When the frames of a text recording were taken. A time without a unit is in seconds, unless the header's
/// SECONDS_PER_FRAME shows it to be in milliseconds; without a time, frames are SECONDS_PER_FRAME apart.
class tekscan_frame_times {
public:
    /// The first line 'Frame' of a recording.
    void begin(const tekscan_frame_line& first) { first_ = first; }

    /// Of a frame, behind `earlier` others; `each` is SECONDS_PER_FRAME.
    [[nodiscard]] std::optional<double> seconds(const tekscan_frame_line& frame, std::uint64_t earlier,
                                                std::optional<double> each) {
        if (!frame.stamp) {
            if (!each)
                return std::nullopt;
            return static_cast<double>(frame.number - first_.number) * *each;
        }
        if (frame.stamp_unit)
            return *frame.stamp * *frame.stamp_unit;
        // Between seconds and milliseconds lies a factor of 1000; what is beyond its middle is milliseconds.
        const std::uint64_t steps = frame.number - (earlier > 0 ? first_.number : 1);
        const double since = *frame.stamp - (earlier > 0 ? first_.stamp.value_or(0) : 0);
        if (!plain_unit_ && since > 0 && steps > 0 && each.value_or(0) > 0)
            plain_unit_ = since / (static_cast<double>(steps) * *each) > std::sqrt(1000.0) ? 1e-3 : 1.0;
        return *frame.stamp * plain_unit_.value_or(1);
    }

private:
    tekscan_frame_line first_;
    std::optional<double> plain_unit_; ///< seconds of a time without a unit, once that shows
};

} // namespace TACTNET_ARCH
} // namespace tactnet
