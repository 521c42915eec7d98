#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/described/description.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// A plain stream of matrices, as a microcontroller sends it: a marker, if any, bytes to skip, the cells, more
// bytes to skip. For other protocols, write a decoder of your own.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The encoding of a cell.
enum class cell_format : std::uint8_t { uint8, uint16_little, uint16_big, float32_little };

/// The layout of the stream.
struct matrix_stream_format {
    std::size_t rows = 0, columns = 0;
    cell_format cell = cell_format::uint8;
    cell_order order = cell_order::rows;
    std::vector<std::byte> marker{}; ///< before every frame
    std::size_t skip_before = 0;     ///< bytes between the marker and the cells
    std::size_t skip_after = 0;      ///< bytes after the cells
    std::optional<double> seconds_per_frame{};
    pressure_unit unit = pressure_unit::raw;
    std::optional<double> row_spacing{}, column_spacing{}; ///< metres
};

/// Decodes such a stream. With a marker it may be joined at any byte: bytes up to the first marker are
/// skipped. After that, a frame that does not begin with the marker, or with a float cell that is NaN,
/// infinite or negative, is reported as damaged, and decoding continues at the next marker.
///
/// Memory: one frame of four bytes per cell, one packet, and a number for each byte of the marker. Time is
/// linear in the bytes, whatever they are.
class matrix_stream : public decoder_base {
public:
    /// Throws std::invalid_argument if there are no cells, or too many cells or bytes to skip.
    explicit matrix_stream(const matrix_stream_format& format)
        : decoder_base(describe(format)), format_(format) {
        packet_.reserve(packet_size());
        for (std::size_t n = 1, border = 0; n < format_.marker.size(); ++n) {
            border = extended(border, format_.marker[n]);
            borders_.push_back(border);
        }
    }

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        set_status(decode_status::reading);
        while (!bytes.empty()) {
            const std::size_t wanted =
                packet_.size() < format_.marker.size() ? 1 : packet_size() - packet_.size();
            const std::size_t consumed = std::min(wanted, bytes.size());
            packet_.insert(packet_.end(), bytes.begin(),
                           bytes.begin() + static_cast<std::ptrdiff_t>(consumed));
            bytes = bytes.subspan(consumed);
            byte_ += consumed;
            if (packet_.size() <= format_.marker.size())
                find_marker();
            if (packet_.size() == packet_size())
                read_packet(sink);
        }
        return status();
    }

    template <class Sink>
    decode_status finish(Sink&&) {
        set_status(decode_status::finished);
        if (!packet_.empty())
            report({"a whole frame of ", packet_size(), " bytes"}, {packet_.size(), " bytes of it"});
        packet_.clear();
        return status();
    }

    /// Number of bytes outside of frames.
    [[nodiscard]] std::uint64_t skipped_bytes() const noexcept { return skipped_; }

private:
    static constexpr std::size_t largest_packet = std::size_t{1} << 24;

    static recording_description describe(const matrix_stream_format& format) {
        if (format.rows == 0 || format.columns == 0 || format.rows > largest_frame_cells / format.columns ||
            std::max({format.marker.size(), format.skip_before, format.skip_after}) > largest_packet / 4)
            detail::throw_invalid_argument(
                {"matrix_stream: expected 1 to ", largest_frame_cells, " cells and at most ",
                 largest_packet / 4, " bytes around them, found ", format.rows, " x ", format.columns});
        return {.format = "matrix stream",
                .rows = format.rows,
                .columns = format.columns,
                .row_spacing = format.row_spacing,
                .column_spacing = format.column_spacing,
                .unit = format.unit,
                .seconds_per_frame = format.seconds_per_frame};
    }

    [[nodiscard]] std::size_t cell_size() const noexcept {
        return format_.cell == cell_format::uint8 ? 1 : format_.cell == cell_format::float32_little ? 4 : 2;
    }
    [[nodiscard]] std::size_t packet_size() const noexcept {
        return format_.marker.size() + format_.skip_before + description().cells() * cell_size() +
               format_.skip_after;
    }

    /// How many bytes begin a marker, of the latest of a stream that ended with the first `count` of one
    /// before `next` came (Knuth, Morris and Pratt, 1977).
    [[nodiscard]] std::size_t extended(std::size_t count, std::byte next) const {
        while (count > 0 && format_.marker[count] != next)
            count = count > 1 ? borders_[count - 2] : 0;
        return format_.marker[count] == next ? count + 1 : 0;
    }
    /// Drops bytes until the rest, which began a marker before the latest byte, may begin one again.
    void find_marker() {
        const std::size_t before = packet_.size() - 1;
        if (packet_.back() == format_.marker[before])
            return;
        if (in_step_)
            report({"the marker of a frame"}, {"other bytes"});
        in_step_ = false;
        const std::size_t kept = extended(before, packet_.back());
        skipped_ += packet_.size() - kept;
        packet_.resize(kept); // what is kept is the beginning of the marker, wherever it stood
    }

    template <class Sink>
    void read_packet(Sink& sink) {
        const std::size_t rows = description().rows, columns = description().columns;
        std::span<const std::byte> from(packet_);
        from = from.subspan(format_.marker.size() + format_.skip_before);
        for (std::size_t i = 0; i < rows * columns; ++i, from = from.subspan(cell_size())) {
            const std::size_t to = format_.order == cell_order::rows ? i : i % rows * columns + i / rows;
            const float value = read_cell(from);
            // True for NaN too.
            if (!(value >= 0 && std::isfinite(value))) {
                report({"cells of zero or more"},
                       {std::to_string(value), " in row ", to / columns + 1, ", column ", to % columns + 1});
                return packet_.clear();
            }
            cells()[to] = value;
        }
        std::optional<double> seconds;
        if (format_.seconds_per_frame)
            seconds = static_cast<double>(frames()) * *format_.seconds_per_frame;
        emit(sink, frames() + 1, seconds);
        in_step_ = true;
        packet_.clear();
    }

    [[nodiscard]] float read_cell(std::span<const std::byte> from) const {
        switch (format_.cell) {
        case cell_format::uint8:
            return static_cast<float>(from[0]);
        case cell_format::uint16_little:
            return static_cast<float>(little_endian<std::uint16_t>(from));
        case cell_format::uint16_big:
            return static_cast<float>(big_endian<std::uint16_t>(from));
        case cell_format::float32_little:
            break;
        }
        return detail::bits_as<float>(little_endian<std::uint32_t>(from));
    }

    void report(detail::text_parts expected, detail::text_parts found) {
        fail({byte_ - packet_.size(), 0, frames() + 1, detail::joined(expected), detail::joined(found)});
    }

    matrix_stream_format format_;
    std::vector<std::byte> packet_;
    /// For each beginning of the marker of two bytes or more, how many of its last bytes begin a marker.
    std::vector<std::size_t> borders_;
    std::size_t byte_ = 0;
    std::uint64_t skipped_ = 0;
    bool in_step_ = false; ///< just after a frame
};

}} // namespace tactnet
