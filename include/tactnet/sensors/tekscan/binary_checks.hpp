#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/sensors/warning.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

// The records of frames, and the redundancy of a binary recording, which reveals damage in a format without a
// checksum. In a recording of I-Scan (500 frames, 9 819 runs, 25 174 counts), no count is zero or below
// NOISE_THRESHOLD, no run begins where the last one ends, frames are numbered consecutively and have the same
// records, and record 16 equals TIME_2 of the header plus record 2. Frames are 10 000 or 10 010 microseconds
// apart for a SECONDS_PER_FRAME of 0.01; in a text recording at 0.1, written to the hundredth, 0.10 or 0.11.
//
// Violations are warnings, since other programs may differ: with an external trigger frames come at any time,
// and dropped frames leave gaps in the numbers.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The contents of the records of one frame of a binary recording, which may be split anywhere.
class tekscan_binary_records {
public:
    /// Tags: the number of the frame (4 bytes), the time since the start in microseconds (8), and the time of
    /// day in units of 100 ns since 1601 (8).
    static constexpr std::uint16_t frame_number = 1, microseconds = 2, time_of_day = 16;

    std::optional<std::uint64_t> number, time, day_time;

    /// The length that a record must have, if any.
    [[nodiscard]] static std::optional<std::size_t> bytes_of(std::uint16_t tag) noexcept {
        return tag == frame_number   ? std::optional<std::size_t>(4)
               : tag == microseconds ? std::optional<std::size_t>(8)
                                     : std::nullopt;
    }

    /// Starts a record, of `bytes_of(tag)` bytes if that is not empty.
    void announce(std::uint16_t tag, std::uint16_t length) noexcept {
        for (const unsigned value : {unsigned{tag}, unsigned{length}})
            layout_ = (layout_ ^ value) * 1099511628211U;
        tag_ = tag;
        length_ = length;
        filled_ = 0;
    }
    /// Takes bytes of the current record, and returns their number. Records with unknown tags, and times of
    /// day of another length, are skipped.
    std::size_t consume(std::span<const std::byte> bytes) noexcept {
        const std::size_t consumed = std::min(bytes.size(), length_ - filled_);
        const bool known =
            tag_ == frame_number || tag_ == microseconds || (tag_ == time_of_day && length_ == 8);
        if (known)
            std::copy_n(bytes.begin(), consumed, data_.begin() + static_cast<std::ptrdiff_t>(filled_));
        filled_ += consumed;
        if (!known || !whole())
            return consumed;
        if (tag_ == frame_number)
            number = little_endian<std::uint32_t>(data_);
        else
            (tag_ == microseconds ? time : day_time) = little_endian<std::uint64_t>(data_);
        return consumed;
    }
    [[nodiscard]] bool whole() const noexcept { return filled_ == length_; }

    /// A hash of tags and lengths in their order.
    [[nodiscard]] std::uint64_t layout() const noexcept { return layout_; }

private:
    std::uint64_t layout_ = 14695981039346656037U; ///< FNV-1a
    std::array<std::byte, 8> data_{};
    std::size_t length_ = 0, filled_ = 0; ///< of the current record
    std::uint16_t tag_ = 0;
};

/// Warns if a recording differs from those of real programs. Uses no heap.
class tekscan_binary_checks {
public:
    /// How far the time of a frame may deviate from SECONDS_PER_FRAME, in frames. Real recordings deviate by
    /// up to a tenth; beyond a half, the time would be nearer to that of another frame.
    static constexpr double time_tolerance = 0.5;

    /// Starts after the header. Warns if it lacks a value that the checks need.
    void begin(const recording_description& description, decoding_warnings& warnings) {
        const auto lacks = [&](bool there, std::string_view key) {
            if (!there)
                warnings.add({0, 1, 0, warning_text("a line '", key, "' in the header"),
                              warning_text("none that can be read")});
        };
        lacks(description.noise_threshold.has_value(), "NOISE_THRESHOLD");
        lacks(description.seconds_per_frame.has_value(), "SECONDS_PER_FRAME");
        lacks(description.frames.has_value(), "FRAMES");
        // At least 1, since no program writes zeros.
        const double threshold = description.noise_threshold.value_or(1);
        smallest_ = static_cast<std::uint8_t>(std::ceil(std::clamp(threshold, 1.0, 255.0)));
        seconds_per_frame_ = description.seconds_per_frame.value_or(0);
        for (const auto& [key, value] : description.header)
            if (key == "TIME_2")
                start_ = hexadecimal(value);
    }

    /// Checks counts of a run, of which the first is in `cell` and at `byte`.
    void counts(std::span<const std::uint8_t> counts, std::size_t cell, std::size_t byte, std::uint64_t frame,
                decoding_warnings& warnings) const noexcept {
        std::uint8_t least = 255;
        for (const std::uint8_t count : counts)
            least = std::min(least, count);
        if (least >= smallest_)
            return;
        for (std::size_t i = 0; i < counts.size(); ++i)
            if (counts[i] < smallest_)
                warnings.add({byte + i, 0, frame,
                              warning_text("counts of at least ", unsigned{smallest_},
                                           smallest_ > 1 ? " (NOISE_THRESHOLD)" : ", as zeros are left out"),
                              warning_text(unsigned{counts[i]}, " in cell ", cell + i)});
    }

    /// Checks a run that begins in `cell`, where `free` is the cell after the last run, or 0.
    static void run(std::size_t cell, std::size_t free, std::size_t byte, std::uint64_t frame,
                    decoding_warnings& warnings) noexcept {
        if (free > 0 && cell == free)
            warnings.add(
                {byte, 0, frame,
                 warning_text("a run from cell ", free + 1, " on, as runs without a gap are written as one"),
                 warning_text("cell ", cell)});
    }

    /// Checks the records of a complete frame with this number, which ends at `byte`.
    void frame(const tekscan_binary_records& records, std::uint64_t number, std::size_t byte,
               std::uint64_t frame, decoding_warnings& warnings) noexcept {
        const auto warn = [&](const warning_text& expected, const warning_text& found) {
            warnings.add({byte, 0, frame, expected, found});
        };
        if (frame > 1) {
            if (number != last_number_ + 1)
                warn(warning_text("frame number ", last_number_ + 1), warning_text("number ", number));
            if (records.layout() != last_.layout())
                warn(warning_text("records with the tags and lengths of the frame before"),
                     warning_text("others"));
            if (records.time && last_.time)
                check_step(*records.time, *last_.time, static_cast<double>(number - last_number_), warn);
        }
        if (records.time && records.day_time)
            check_day_time(*records.day_time, *records.time, warn);
        last_ = records;
        last_number_ = number;
    }

private:
    static std::optional<std::uint64_t> hexadecimal(std::string_view text) noexcept {
        std::uint64_t value = 0;
        const auto end = std::from_chars(text.data(), text.data() + text.size(), value, 16);
        if (end.ec != std::errc() || end.ptr != text.data() + text.size())
            return std::nullopt;
        return value;
    }

    /// Checks the times, in microseconds, of two frames `steps` apart.
    template <class Warn>
    void check_step(std::uint64_t time, std::uint64_t last, double steps, Warn& warn) const noexcept {
        const double found = (static_cast<double>(time) - static_cast<double>(last)) / 1e6;
        const double expected = steps * seconds_per_frame_;
        if (seconds_per_frame_ > 0 ? std::abs(found - expected) > time_tolerance * expected : found < 0)
            warn(seconds_per_frame_ > 0 ? warning_text("a time about ", expected, " s after the frame before")
                                        : warning_text("a time after the frame before"),
                 warning_text(found, " s"));
    }

    /// Checks record 16 against record 2, modulo 2^64. The result is the start for the next frame, so that
    /// one damaged time does not warn in every frame.
    template <class Warn>
    void check_day_time(std::uint64_t day_time, std::uint64_t time, Warn& warn) noexcept {
        const std::uint64_t start = day_time - 10 * time;
        if (start != start_.value_or(start))
            warn(warning_text("a time of day (record 16) of ", *start_ + 10 * time, ", as record 2 gives"),
                 warning_text(day_time));
        start_ = start;
    }

    std::uint8_t smallest_ = 1; ///< count at or above NOISE_THRESHOLD
    double seconds_per_frame_ = 0;
    tekscan_binary_records last_{};
    std::uint64_t last_number_ = 0;
    std::optional<std::uint64_t> start_; ///< the time of day at which record 2 is zero
};

}} // namespace tactnet
