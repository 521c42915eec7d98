#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/sensors/decoder.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace tactnet {
inline namespace TACTNET_ARCH {

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
        taken_ = 0;
    }
    /// Takes bytes of the current record, and returns their number. Records with unknown tags, and times of
    /// day of another length, are skipped.
    std::size_t take(std::span<const std::byte> bytes) noexcept {
        const std::size_t taken = std::min(bytes.size(), length_ - taken_);
        const bool known =
            tag_ == frame_number || tag_ == microseconds || (tag_ == time_of_day && length_ == 8);
        if (known)
            std::copy_n(bytes.begin(), taken, data_.begin() + static_cast<std::ptrdiff_t>(taken_));
        taken_ += taken;
        if (!known || !whole())
            return taken;
        if (tag_ == frame_number)
            number = little_endian<std::uint32_t>(data_);
        else
            (tag_ == microseconds ? time : day_time) = little_endian<std::uint64_t>(data_);
        return taken;
    }
    [[nodiscard]] bool whole() const noexcept { return taken_ == length_; }

    /// A hash of tags and lengths in their order.
    [[nodiscard]] std::uint64_t layout() const noexcept { return layout_; }

private:
    std::uint64_t layout_ = 14695981039346656037U; ///< FNV-1a
    std::array<std::byte, 8> data_{};
    std::size_t length_ = 0, taken_ = 0; ///< of the current record
    std::uint16_t tag_ = 0;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
