#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Decoders of Weiss Robotics' tactile controllers. A packet is AA AA AA, an identifier, u16 size, a payload
// of that size and a CRC-16; the lowest byte of a number comes first. A frame has the identifier 0 and a
// payload of u32 time stamp, u8 flags and cells: u16 each, or, if the lowest flag is set, in runs of a u16
// each, whose low 12 bits are the value and whose high 4 bits are the number of cells. The controllers differ
// in which bytes the checksum covers.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The table of the polynomial 1021.
inline constexpr auto weiss_table = [] {
    std::array<std::uint16_t, 256> entries{};
    for (std::size_t i = 0; i < entries.size(); ++i) {
        std::uint32_t entry = static_cast<std::uint32_t>(i) << 8U;
        for (int bit = 0; bit < 8; ++bit)
            entry = (entry << 1U) ^ ((entry & 0x8000U) != 0 ? 0x1021U : 0U);
        entries[i] = static_cast<std::uint16_t>(entry);
    }
    return entries;
}();

/// What follows a checksum after a byte. It is linear: the exclusive or of what follows the one, of what
/// follows the other and of zero.
[[nodiscard]] constexpr std::uint16_t weiss_next(std::uint16_t value, std::byte byte) noexcept {
    return static_cast<std::uint16_t>(weiss_table[(value ^ static_cast<std::uint8_t>(byte)) & 0xFFU] ^
                                      (value >> 8U));
}

/// The columns of a matrix of bits, times a vector.
using weiss_matrix = std::array<std::uint16_t, 16>;
[[nodiscard]] constexpr std::uint16_t product(const weiss_matrix& columns, std::uint16_t value) noexcept {
    std::uint16_t sum = 0;
    for (std::size_t bit = 0; bit < columns.size(); ++bit)
        sum = static_cast<std::uint16_t>(sum ^ ((value >> bit & 1U) != 0 ? columns[bit] : 0U));
    return sum;
}
/// What 1, 2, 4, … bytes of zero make of a checksum.
inline constexpr auto weiss_zeros = [] {
    std::array<weiss_matrix, 17> powers{};
    for (std::size_t bit = 0; bit < 16; ++bit)
        powers[0][bit] = weiss_next(static_cast<std::uint16_t>(1U << bit), std::byte{0});
    for (std::size_t k = 1; k < powers.size(); ++k)
        for (std::size_t bit = 0; bit < 16; ++bit)
            powers[k][bit] = product(powers[k - 1], powers[k - 1][bit]);
    return powers;
}();

} // namespace detail

/// CRC-16 with the polynomial 1021 and the start value FFFF. As in these controllers, the table is that of
/// the form that is not reflected, but values are shifted to the right.
[[nodiscard]] constexpr std::uint16_t weiss_checksum(std::span<const std::byte> bytes) noexcept {
    std::uint16_t value = 0xFFFF;
    for (const std::byte byte : bytes)
        value = detail::weiss_next(value, byte);
    return value;
}

/// The array of a live stream, which does not describe itself.
struct weiss_array {
    std::size_t rows = 0, columns = 0;
    std::optional<double> row_spacing{}, column_spacing{}; ///< metres
    double seconds_per_tick = 1e-3;                        ///< unit of time stamps
};

/// Which bytes the checksum covers.
enum class weiss_coverage : std::uint8_t { whole_packet, without_preamble };

/// Decodes a live stream of packets, which may be joined at any byte: bytes up to the first packet are
/// counted and skipped. Packets with other identifiers, which answer commands, are skipped too. After a
/// packet, bytes that do not begin one are reported as damaged (further preamble is not), and so is a packet
/// with a wrong checksum or a frame of another size; decoding continues after it. A push that reports damage
/// has taken all its bytes: `error` describes the last damage, `damaged_packets` counts all. The checksum of
/// these controllers does not find every pair of flipped bits.
///
/// Memory: one frame of four bytes per cell, and six bytes for each byte of the largest packet, which has two
/// bytes per cell and 13 more, but at least 263 and at most 65 543. Time is linear in the bytes, whatever
/// they are: the checksum of any part of the stream follows from those of all bytes before its ends.
class weiss_decoder : public decoder_base {
public:
    weiss_decoder(std::string format, const weiss_array& array, weiss_coverage coverage)
        : decoder_base(describe(std::move(format), array)),
          coverage_(coverage),
          seconds_per_tick_(array.seconds_per_tick) {
        buffer_.reserve(2 * largest_packet());
        sums_.reserve(2 * largest_packet());
    }

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        set_status(decode_status::reading);
        for (const std::byte byte : bytes) {
            buffer_.push_back(byte);
            sums_.push_back(sum_);
            sum_ = detail::weiss_next(sum_, byte);
            ++byte_;
            while (waiting() > 0 && complete(sink)) {
            }
            if (waiting() == 0 || first_ >= largest_packet())
                drop_examined();
        }
        return status();
    }

    /// Ends the stream. A packet that is not complete is reported.
    template <class Sink>
    decode_status finish(Sink&&) {
        set_status(decode_status::finished);
        if (waiting() > 0)
            report(byte_, {"a whole packet"}, {waiting(), " bytes of one"});
        first_ = buffer_.size();
        drop_examined();
        return status();
    }

    [[nodiscard]] std::uint64_t damaged_packets() const noexcept { return damaged_; }
    /// Number of bytes outside of packets.
    [[nodiscard]] std::uint64_t skipped_bytes() const noexcept { return skipped_; }

private:
    static constexpr std::size_t preamble_size = 3, header_size = 6, checksum_size = 2, stamp_and_flags = 5;
    static constexpr std::byte preamble{0xAA};
    static constexpr std::byte frame_identifier{0};

    static recording_description describe(std::string format, const weiss_array& array) {
        if (array.rows == 0 || array.columns == 0 || array.rows > largest_frame_cells / array.columns)
            detail::throw_invalid_argument({"weiss_decoder: expected 1 to ", largest_frame_cells,
                                            " cells, found ", array.rows, " x ", array.columns});
        return {.format = std::move(format),
                .rows = array.rows,
                .columns = array.columns,
                .row_spacing = array.row_spacing,
                .column_spacing = array.column_spacing};
    }

    /// The largest payload of a frame or an answer, so that the stream does not wait for a damaged size.
    [[nodiscard]] std::size_t largest_payload() const {
        return std::clamp<std::size_t>(stamp_and_flags + 2 * description().cells(), 255, 0xFFFF);
    }

    [[nodiscard]] std::size_t largest_packet() const {
        return header_size + largest_payload() + checksum_size;
    }
    /// Bytes in the buffer that have not been examined, or not to the end.
    [[nodiscard]] std::size_t waiting() const noexcept { return buffer_.size() - first_; }
    void drop_examined() {
        const auto count = static_cast<std::ptrdiff_t>(first_);
        buffer_.erase(buffer_.begin(), buffer_.begin() + count);
        sums_.erase(sums_.begin(), sums_.begin() + count);
        first_ = 0;
    }
    /// The checksum of `count` bytes from `begin` on, counted from the first that was not examined.
    [[nodiscard]] std::uint16_t checksum_of(std::size_t begin, std::size_t count) const noexcept {
        auto before = static_cast<std::uint16_t>(sums_[first_ + begin] ^ 0xFFFFU);
        for (std::size_t power = 0; power < detail::weiss_zeros.size(); ++power)
            if ((count >> power & 1U) != 0)
                before = detail::product(detail::weiss_zeros[power], before);
        return static_cast<std::uint16_t>(before ^ sums_[first_ + begin + count]);
    }

    /// Examines the bytes in the buffer. Returns true if it has removed some, so that the rest must be
    /// examined.
    template <class Sink>
    bool complete(Sink& sink) {
        const std::span<const std::byte> packet = std::span<const std::byte>(buffer_).subspan(first_);
        const auto is_preamble = [](std::byte b) { return b == preamble; };
        if (!std::all_of(packet.begin(),
                         packet.begin() + static_cast<std::ptrdiff_t>(std::min(packet.size(), preamble_size)),
                         is_preamble))
            return skip_one();
        if (packet.size() < header_size)
            return false;
        const std::size_t size = little_endian<std::uint16_t>(packet.subspan(4));
        if (size > largest_payload())
            return skip_one();
        if (packet.size() < header_size + size + checksum_size)
            return false;
        const std::size_t from = coverage_ == weiss_coverage::whole_packet ? 0 : preamble_size;
        const std::uint16_t checksum = checksum_of(from, header_size + size - from);
        const auto given = little_endian<std::uint16_t>(packet.subspan(header_size + size));
        if (given != checksum) {
            report(byte_ - packet.size(), {"a checksum of ", checksum}, {given});
            in_step_ = false;
            return skip_one();
        }
        if (packet[preamble_size] == frame_identifier)
            read_frame(packet.subspan(header_size, size), sink);
        // More may follow where a damaged size has reached into the packets after it.
        first_ += header_size + size + checksum_size;
        in_step_ = true;
        return true;
    }

    bool skip_one() {
        if (in_step_ && buffer_[first_] != preamble) {
            report(byte_ - waiting(), {"a packet"}, {"other bytes"});
            in_step_ = false;
        }
        ++skipped_;
        ++first_;
        return true;
    }

    template <class Sink>
    void read_frame(std::span<const std::byte> payload, Sink& sink) {
        const std::size_t size = description().cells();
        const std::size_t start = byte_ - waiting();
        if (payload.size() < stamp_and_flags)
            return report(start, {"a frame with a time stamp"}, {payload.size(), " bytes"});
        const auto stamp = little_endian<std::uint32_t>(payload);
        const bool runs = (payload[4] & std::byte{1}) != std::byte{0};
        payload = payload.subspan(stamp_and_flags);
        std::size_t cell = 0;
        for (; payload.size() >= 2; payload = payload.subspan(2)) {
            const auto word = little_endian<std::uint16_t>(payload);
            const std::size_t count = runs ? word >> 12U : 1;
            if (count > size - cell || count == 0)
                return report(start, {"runs of 1 to 15 cells, ", size, " in all"}, {count, " after ", cell});
            std::fill_n(cells().begin() + static_cast<std::ptrdiff_t>(cell), count,
                        static_cast<float>(runs ? word & 0x0FFFU : word));
            cell += count;
        }
        if (cell != size || !payload.empty())
            return report(start, {size, " cells"}, {cell, payload.empty() ? "" : " and half of one"});
        emit(sink, frames() + 1, static_cast<double>(stamp) * seconds_per_tick_);
    }

    void report(std::size_t byte, detail::text_parts expected, detail::text_parts found) {
        ++damaged_;
        fail({byte, 0, frames() + 1, detail::joined(expected), detail::joined(found)});
    }

    weiss_coverage coverage_;
    double seconds_per_tick_;
    std::vector<std::byte> buffer_;
    std::vector<std::uint16_t> sums_; ///< of all bytes before each of the buffer, from 0 on
    std::size_t first_ = 0;           ///< the first of the buffer that has not been examined
    std::uint16_t sum_ = 0;
    std::size_t byte_ = 0;
    std::uint64_t damaged_ = 0, skipped_ = 0;
    bool in_step_ = false; ///< after a whole packet, perhaps with more preamble
};

/// Decodes frames of a WTS sensor, whose checksum covers the whole packet. See weiss_decoder.
class weiss_wts : public weiss_decoder {
public:
    /// Throws std::invalid_argument if rows × columns is not 1 to largest_frame_cells.
    explicit weiss_wts(const weiss_array& array)
        : weiss_decoder("Weiss WTS", array, weiss_coverage::whole_packet) {}
};

/// Decodes frames of a DSACON32m controller, as in the Schunk SDH hand: the checksum does not cover the
/// preamble, and cells usually come in runs. A frame holds the cells of all matrices, one after the other.
/// See weiss_decoder.
class dsacon32m : public weiss_decoder {
public:
    /// Throws std::invalid_argument if rows × columns is not 1 to largest_frame_cells.
    explicit dsacon32m(const weiss_array& array)
        : weiss_decoder("DSACON32m", array, weiss_coverage::without_preamble) {}
};

}} // namespace tactnet
