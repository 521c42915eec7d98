#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/described/cell_reader.hpp>
#include <tactnet/sensors/described/description.hpp>
#include <tactnet/sensors/described/packet_finder.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// A stream of binary packets, as a microcontroller sends it.

namespace tactnet { inline namespace TACTNET_ARCH {

/// When a frame of a stream is given to the sink.
enum class frame_delivery : std::uint8_t {
    /// As soon as later bytes confirm it: one frame later, without delay if there is a checksum. All frames
    /// are certain but the last before the stream ends.
    confirmed,
    /// As soon as its last byte is there. A lost byte gives a frame of which a part is shifted, and cells
    /// that
    /// look like a marker give more. Only frames with a checksum may be certain: see frame_view::certain.
    immediate
};

/// Decodes a stream of packets of a described array, which may be joined at any byte.
///
/// After damage, the decoder looks for a packet again from the next byte on, and reports once that bytes were
/// skipped. Cells that look like a marker do not mislead it: while two places in the stream fit equally well,
/// it reports so and delivers nothing (packet_finder.hpp). A changed byte inside of a frame is only found
/// with a checksum, and of several at once, as few as the checksum misses. Without marker and checksum,
/// frames follow each other from the first byte on, and nothing is checked.
///
/// Memory: one frame of four bytes per cell, at most nine packets, and up to 64 KiB of a push. Time is linear
/// in the bytes; with a checksum, also in the number of places with a marker.
class matrix_stream : public decoder_base {
public:
    /// Throws std::invalid_argument for a description that cannot be, or of digits.
    explicit matrix_stream(const sensor_description& description,
                           frame_delivery delivery = frame_delivery::confirmed)
        : decoder_base(describe(binary(description), "matrix stream")),
          reader_(description),
          finder_(description),
          cells_at_(description.marker.size() + description.header_bytes),
          delivery_(description.marker.empty() && !finder_.has_checksum() ? frame_delivery::immediate
                                                                          : delivery),
          unmarked_(description.marker.empty() && !finder_.has_checksum()) {
        bytes_.reserve(2 * finder_.packet_bytes());
    }

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        set_status(decode_status::reading);
        const std::size_t piece = std::max(std::size_t{1} << 16U, finder_.packet_bytes());
        while (!bytes.empty()) {
            const std::size_t size = std::min(piece, bytes.size());
            bytes_.insert(bytes_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
            bytes = bytes.subspan(size);
            if (delivery_ == frame_delivery::confirmed)
                confirm(sink, false);
            else
                deliver(sink);
            forget();
        }
        return status();
    }

    /// Ends the stream. The last packet, which nothing follows, is delivered as a frame that is not certain
    /// unless it has a checksum; a packet that is not complete is reported.
    template <class Sink>
    decode_status finish(Sink&& sink) {
        set_status(decode_status::finished);
        if (delivery_ == frame_delivery::confirmed)
            confirm(sink, true);
        const std::uint64_t end = begin_ + bytes_.size();
        const std::uint64_t rest = delivery_ == frame_delivery::confirmed || in_step_
                                       ? end - std::min(end, last_end_)
                                       : end - std::min(end, cursor_);
        if (rest > 0 && (last_end_ > 0 || rest < finder_.packet_bytes()) &&
            status() != decode_status::damaged)
            report(end - rest, {"a whole frame of ", finder_.packet_bytes(), " bytes"},
                   {rest, " bytes of it"});
        bytes_.clear();
        return status();
    }

    /// Number of bytes outside of frames.
    [[nodiscard]] std::uint64_t skipped_bytes() const noexcept { return skipped_; }

private:
    static const sensor_description& binary(const sensor_description& d) {
        if (d.cell == cell_type::digits)
            detail::throw_invalid_argument({"matrix_stream: expected cells of bytes, found digits"});
        return d;
    }
    [[nodiscard]] std::span<const std::byte> from(std::uint64_t place) const noexcept {
        return std::span(bytes_).subspan(static_cast<std::size_t>(place - begin_));
    }

    /// Delivers all packets that are certain.
    template <class Sink>
    void confirm(Sink& sink, bool at_end) {
        const std::size_t size = finder_.packet_bytes();
        while (true) {
            while (!finder_.any() && finder_.read_to() + finder_.hit_bytes() <= begin_ + bytes_.size())
                finder_.read(bytes_, begin_, finder_.read_to() + 1);
            if (!finder_.any())
                return;
            finder_.read(bytes_, begin_, finder_.due());
            const std::uint64_t at = finder_.first();
            const bool whole = begin_ + bytes_.size() >= at + size;
            if (finder_.continues() && whole && finder_.read_to() > at) {
                read_packet(at, true, sink);
                continue;
            }
            const bool can_judge = finder_.can_judge();
            if ((!can_judge && !at_end) || !whole)
                return;
            const packet_state state = finder_.judge(!can_judge);
            if (state == packet_state::certain) {
                read_packet(at, can_judge || finder_.has_checksum(), sink);
            } else if (state != packet_state::unknown) {
                if (state == packet_state::ambiguous && !ambiguous_) {
                    ambiguous_ = true;
                    report(at, {"the start of a packet at one place of every frame"},
                           {"two or more that fit"});
                }
                finder_.drop(state);
            }
        }
    }

    template <class Sink>
    void read_packet(std::uint64_t at, bool certain, Sink& sink) {
        skip_to(at);
        emit_packet(at, certain, sink);
        finder_.accept();
        ambiguous_ = false;
    }

    /// Delivers packets as soon as they are there.
    template <class Sink>
    void deliver(Sink& sink) {
        const std::size_t size = finder_.packet_bytes();
        while (true) {
            const std::uint64_t end = begin_ + bytes_.size();
            if (in_step_ && !unmarked_) {
                if (end < cursor_ + finder_.hit_bytes())
                    return;
                if (!finder_.fits(from(cursor_))) {
                    in_step_ = false;
                    report(cursor_, {"the marker of a frame"}, {"other bytes"});
                    cursor_ -= size - 1; // again from the next byte of the frame before
                }
            }
            if (!in_step_) {
                cursor_ = begin_ + finder_.find(bytes_, static_cast<std::size_t>(cursor_ - begin_));
                if (end < cursor_ + finder_.hit_bytes())
                    return;
            }
            if (end < cursor_ + size)
                return;
            const bool follows = in_step_ && last_end_ == cursor_;
            skip_to(cursor_);
            emit_packet(cursor_, unmarked_ || (finder_.has_checksum() && follows), sink);
            cursor_ = last_end_;
            in_step_ = true;
        }
    }

    /// Counts bytes outside of frames.
    void skip_to(std::uint64_t at) {
        if (at <= last_end_)
            return;
        if (last_end_ > 0 && delivery_ == frame_delivery::confirmed)
            report(last_end_, {"the marker of a frame"}, {"other bytes"});
        skipped_ += at - last_end_;
    }

    template <class Sink>
    void emit_packet(std::uint64_t at, bool certain, Sink& sink) {
        const std::size_t bad = reader_.read(from(at).data() + cells_at_, cells());
        last_end_ = at + finder_.packet_bytes();
        if (bad < cells().size()) {
            const std::size_t columns = description().columns;
            return report(at, {"cells of zero or more"},
                          {"another value in row ", bad / columns + 1, ", column ", bad % columns + 1});
        }
        std::optional<double> seconds;
        if (description().seconds_per_frame)
            seconds = static_cast<double>(frames()) * *description().seconds_per_frame;
        emit(sink, frames() + 1, seconds, certain);
    }

    /// Drops bytes that are no longer needed.
    void forget() {
        const std::uint64_t needed =
            delivery_ == frame_delivery::confirmed
                ? (finder_.any() ? finder_.first() : finder_.read_to())
                : cursor_ - std::min<std::uint64_t>(cursor_ - begin_, finder_.packet_bytes());
        const auto count = static_cast<std::size_t>(needed - begin_);
        if (count < bytes_.size() / 2)
            return;
        bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
        begin_ = needed;
    }

    void report(std::uint64_t byte, detail::text_parts expected, detail::text_parts found) {
        fail({static_cast<std::size_t>(byte), 0, frames() + 1, detail::joined(expected),
              detail::joined(found)});
    }

    cell_reader reader_;
    packet_finder finder_;
    std::size_t cells_at_; ///< bytes before the cells of a packet
    frame_delivery delivery_;
    bool unmarked_;
    std::vector<std::byte> bytes_; ///< of the stream, from number `begin_` on
    std::uint64_t begin_ = 0, cursor_ = 0, last_end_ = 0, skipped_ = 0;
    bool in_step_ = false; ///< just after a frame
    bool ambiguous_ = false;
};

}} // namespace tactnet
