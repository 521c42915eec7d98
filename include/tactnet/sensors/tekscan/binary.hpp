#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/tekscan/binary_checks.hpp>
#include <tactnet/sensors/tekscan/binary_header.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

// Tekscan's binary recordings (.fsx): a text header, the bytes 0A BB BA, and frames. A frame has runs of
// nonzero cells, { u16 cell, u8 count, count bytes }, up to FFFF, and records { u16 tag, u16 length, data },
// up to FFFF. FF FE instead of a frame ends the recording. Numbers are little-endian. Cells are raw counts;
// the unit in the header is for display only.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Decodes a binary recording. The sink gets a frame with its last byte. Frames without a time of their own
/// are SECONDS_PER_FRAME apart.
///
/// The format has no checksum. Bytes that no known program writes are warnings (see tekscan_binary_checks).
/// Undetectable damage: a count corrupted into another one of at least NOISE_THRESHOLD, a run that moved
/// within the gap between its neighbours, bytes removed from or added to a run that happen to leave valid
/// runs, and plausible values of ROWS, COLS, spacing and threshold (a mask fixes the size).
///
/// A frame is certain once the next complete frame, or the announced end, follows without a warning. Then its
/// bytes are at their places; counts may still be wrong. From the first warning in a frame on, no frame is
/// certain.
///
/// Memory: one frame (five bytes per cell, at most 65 279 cells), one header of at most largest_header_bytes
/// and largest_header_lines, as text and as keys and values, and one run or record. Nothing is allocated
/// after the header.
class tekscan_binary : public decoder_base {
public:
    /// With the mask of the sensor's map, a run on a cell without a tactel and a mask of another size are
    /// errors.
    explicit tekscan_binary(std::vector<std::uint8_t> mask = {}) {
        mutable_description().format = "Tekscan binary";
        mutable_description().mask = std::move(mask);
        set_certain_frames(0);
    }

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        while (!bytes.empty() && status() != decode_status::damaged) {
            if (status() == decode_status::finished) {
                fail_at(byte_, {"nothing after the closing FF FE"}, {"more bytes"});
                break;
            }
            const std::size_t consumed = part_ == part::header      ? consume_header(bytes)
                                         : part_ == part::run_cells ? consume_run(bytes)
                                         : part_ == part::data      ? consume_record(bytes)
                                                                    : consume_number(bytes, sink);
            byte_ += consumed;
            bytes = bytes.subspan(consumed);
        }
        return status();
    }

    template <class Sink>
    decode_status finish(Sink&&) {
        if (status() == decode_status::reading)
            fail_at(byte_,
                    {part_ == part::header ? "a header that ends with the bytes 0A BB BA"
                                           : "frames and a closing FF FE"},
                    {"the end of the data"});
        return status();
    }

private:
    using records = tekscan_binary_records;
    enum class part : std::uint8_t { header, run_cell, run_count, run_cells, tag, length, data };
    static constexpr std::uint16_t end_of_list = 0xFFFF, end_of_recording = 0xFEFF;
    static_assert(tekscan_binary_header::largest_cells <= end_of_recording);

    std::size_t consume_header(std::span<const std::byte> bytes) {
        const std::size_t consumed = header_.consume(bytes, mutable_description(), mutable_warnings());
        if (header_.problem()) {
            fail(*header_.problem());
        } else if (header_.complete()) {
            resize_cells();
            checks_.begin(description(), mutable_warnings());
            header_warnings_ = warnings().count();
            part_ = part::run_cell;
        }
        return consumed;
    }

    /// Takes the one or two bytes of the next number.
    template <class Sink>
    std::size_t consume_number(std::span<const std::byte> bytes, Sink& sink) {
        const std::size_t size = part_ == part::run_count ? 1 : 2;
        if (gathered_ == 0)
            number_byte_ = byte_;
        if (gathered_ == 0 && bytes.size() >= size) {
            number(bytes, sink);
            return size;
        }
        small_[gathered_++] = bytes[0];
        if (gathered_ == size) {
            gathered_ = 0;
            number(small_, sink);
        }
        return 1;
    }

    template <class Sink>
    void number(std::span<const std::byte> bytes, Sink& sink) {
        if (part_ == part::run_count) {
            count_ = static_cast<std::size_t>(bytes[0]);
            if (count_ == 0 || cell_ + count_ > description().cells())
                return fail_at(number_byte_,
                               {"a run of 1 to ", description().cells() - cell_, " cells from cell ", cell_},
                               {count_});
            part_ = part::run_cells;
            return;
        }
        const auto value = little_endian<std::uint16_t>(bytes);
        if (part_ == part::run_cell)
            begin_run(value);
        else if (part_ == part::tag)
            begin_record(value, sink);
        else
            record_length(value);
    }

    void begin_run(std::uint16_t value) {
        if (value == end_of_list) {
            part_ = part::tag;
        } else if (value == end_of_recording && !in_frame_) {
            end();
        } else if (value >= description().cells() || value < cell_) {
            fail_at(number_byte_,
                    {"a run from cell ", cell_, " of ", description().cells(),
                     " on, FFFF or, after a frame, FF FE"},
                    {"cell ", value});
        } else {
            tekscan_binary_checks::run(value, cell_, number_byte_, frames() + 1, mutable_warnings());
            cell_ = value;
            part_ = part::run_count;
            in_frame_ = true;
        }
    }

    std::size_t consume_run(std::span<const std::byte> bytes) {
        const std::size_t consumed = std::min(bytes.size(), count_);
        const auto* const from = reinterpret_cast<const std::uint8_t*>(bytes.data());
        std::copy_n(from, consumed, cells().data() + cell_);
        // Warnings come before errors, as if bytes came one by one.
        const std::size_t right = on_tactels(consumed);
        checks_.counts({from, right}, cell_, byte_, frames() + 1, mutable_warnings());
        if (right < consumed) {
            fail_at(byte_ + right, {"counts on tactels of the map only"}, {"one in cell ", cell_ + right});
            return 0;
        }
        cell_ += consumed;
        count_ -= consumed;
        if (count_ == 0)
            part_ = part::run_cell;
        return consumed;
    }

    /// Number of cells before the next cell without a tactel.
    [[nodiscard]] std::size_t on_tactels(std::size_t count) const {
        if (description().mask.empty())
            return count;
        const auto begin = description().mask.begin() + static_cast<std::ptrdiff_t>(cell_);
        return static_cast<std::size_t>(
            std::find(begin, begin + static_cast<std::ptrdiff_t>(count), std::uint8_t{0}) - begin);
    }

    template <class Sink>
    void begin_record(std::uint16_t value, Sink& sink) {
        if (value == end_of_list)
            return end_frame(sink);
        tag_ = value;
        part_ = part::length;
    }

    void record_length(std::uint16_t value) {
        const std::size_t wanted = records::bytes_of(tag_).value_or(value);
        if (value != wanted)
            return fail_at(number_byte_, {"a record ", tag_, " of ", wanted, " bytes"}, {value});
        records_.announce(tag_, value);
        part_ = value > 0 ? part::data : part::tag;
    }

    std::size_t consume_record(std::span<const std::byte> bytes) {
        const std::size_t consumed = records_.consume(bytes);
        if (records_.whole())
            part_ = part::tag;
        return consumed;
    }

    template <class Sink>
    void end_frame(Sink& sink) {
        const std::uint64_t number = records_.number.value_or(last_number_ + 1);
        if (frames() > 0 && number <= last_number_)
            return fail_at(number_byte_, {"a frame after number ", last_number_}, {"number ", number});
        if (description().frames && frames() == *description().frames)
            return fail_at(number_byte_, {frames(), " frames as the header announces"}, {"one more"});
        if (frames() == 0)
            first_number_ = number;
        last_number_ = number;
        checks_.frame(records_, number, number_byte_, frames() + 1, mutable_warnings());
        std::optional<double> seconds;
        if (records_.time)
            seconds = static_cast<double>(*records_.time) / 1e6;
        else if (description().seconds_per_frame)
            seconds = static_cast<double>(number - first_number_) * *description().seconds_per_frame;
        confirm_frames();
        emit(sink, number, seconds);
        std::fill(cells().begin(), cells().end(), 0.0f);
        cell_ = 0;
        records_ = {};
        in_frame_ = false;
        part_ = part::run_cell;
    }

    void end() {
        if (missing_frames().value_or(0) > 0)
            return fail_at(number_byte_, {*description().frames, " frames as the header announces"},
                           {frames(), " before FF FE"});
        confirm_frames();
        set_status(decode_status::finished);
    }

    /// Makes the frames so far certain. Only warnings about the header may have come before.
    void confirm_frames() noexcept {
        if (warnings().count() == header_warnings_)
            set_certain_frames(frames());
    }

    void fail_at(std::size_t byte, detail::text_parts expected, detail::text_parts found) {
        fail({byte, 0, part_ == part::header ? 0 : frames() + 1, detail::joined(expected),
              detail::joined(found), missing_frames()});
    }

    tekscan_binary_header header_;
    tekscan_binary_checks checks_;
    records records_;
    std::uint64_t header_warnings_ = 0;
    part part_ = part::header;
    std::size_t byte_ = 0, number_byte_ = 0; ///< offsets of the next byte and of the current number
    std::array<std::byte, 2> small_{};       ///< a number split between pushes
    std::size_t gathered_ = 0, cell_ = 0, count_ = 0;
    std::uint16_t tag_ = 0;
    bool in_frame_ = false; ///< between the first run of a frame and its end
    std::uint64_t first_number_ = 0, last_number_ = 0;
};

}} // namespace tactnet
