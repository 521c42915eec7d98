#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/described/cell_reader.hpp>
#include <tactnet/sensors/described/description.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// What decoders of files share that have a head, which states size and type of cells, and frames after it.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Base class of such decoders. A `Format` has `read_head(bytes, description)`, which sets rows, columns and
/// cells, and returns the bytes of the head and the frames after it; nothing if bytes are missing, or after
/// `damage`.
///
/// Memory: the head, one frame as bytes and one of four bytes per cell, and up to 64 KiB of a push.
template <class Format>
class frame_file : public decoder_base {
public:
    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        constexpr std::size_t piece = std::size_t{1} << 16U;
        while (!bytes.empty() && status() != decode_status::damaged) {
            const auto some = bytes.first(std::min(piece, bytes.size()));
            bytes_.insert(bytes_.end(), some.begin(), some.end());
            bytes = bytes.subspan(some.size());
            while (status() != decode_status::damaged && (left_ > 0 ? read_frame(sink) : begin())) {
            }
            bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_));
            byte_ += std::exchange(at_, 0);
        }
        return status();
    }
    template <class Sink>
    decode_status finish(Sink&&) {
        if (status() == decode_status::damaged)
            return status();
        if (left_ > 0)
            damage({frame_bytes_, " bytes of a frame"}, {bytes_.size(), " of them"});
        else if (!bytes_.empty() || !reader_)
            damage({"a whole head"}, {"the end of the data"});
        else
            set_status(decode_status::finished);
        return status();
    }

protected:
    /// What `read_head` found.
    struct head {
        std::size_t bytes = 0;
        std::uint64_t frames = 0;
        std::size_t largest = 0; ///< a cell, an integer with its higher byte first; 0 if not stated
    };
    /// Counts are as `sensor` states them; its rows and columns, unless they are
    /// zero, are those of the file.
    frame_file(const char* format, sensor_description sensor) : sensor_(std::move(sensor)) {
        mutable_description().format = format;
        // Of a device, not of a file.
        sensor_.marker.clear(), sensor_.checksum = {}, sensor_.decimal_comma = false;
        sensor_.header_bytes = sensor_.trailer_bytes = sensor_.end_bytes = 0;
    }
    void damage(detail::text_parts expected, detail::text_parts found) {
        fail({byte_ + at_, 0, reader_ ? frames() + 1 : 0, detail::joined(expected), detail::joined(found),
              missing_frames()});
    }

private:
    bool begin() {
        const auto bytes = std::span<const std::byte>(bytes_).subspan(at_);
        if (bytes.empty())
            return false;
        sensor_description d = sensor_;
        const std::optional<head> found = static_cast<Format&>(*this).read_head(bytes, d);
        if (!found) {
            if (status() != decode_status::damaged && bytes.size() >= largest_header_bytes)
                damage({"a head of less than ", largest_header_bytes, " bytes"}, {"a longer one"});
            return false;
        }
        if (const auto problem = problem_of(d))
            return damage({problem->field, ": ", problem->expected}, {problem->found}), false;
        const sensor_description& own = reader_ ? first_ : sensor_;
        if (own.cells() > 0 && (own.rows != d.rows || own.columns != d.columns))
            return damage({own.rows, " x ", own.columns, " cells"}, {d.rows, " x ", d.columns}), false;
        if (!reader_) {
            mutable_description() = describe(d, description().format);
            resize_cells();
        }
        reader_.emplace(d);
        frame_bytes_ = d.cells() * d.cell_size();
        left_ = found->frames, largest_ = found->largest;
        mutable_description().frames = frames() + left_;
        at_ += found->bytes;
        first_ = std::move(d);
        return true;
    }
    template <class Sink>
    bool read_frame(Sink& sink) {
        if (bytes_.size() - at_ < frame_bytes_)
            return false;
        for (std::size_t i = 0, from = at_; largest_ > 0 && i < cells().size(); ++i) {
            std::size_t value = 0;
            for (const std::size_t end = from + first_.cell_size(); from < end; ++from)
                value = value << 8U | std::to_integer<std::size_t>(bytes_[from]);
            if (value > largest_)
                return damage({"cells of at most ", largest_}, {value, " in row ", i / first_.columns + 1,
                                                                ", column ", i % first_.columns + 1}),
                       false;
        }
        const std::size_t bad = reader_->read(bytes_.data() + at_, cells());
        if (bad < cells().size())
            return damage({"cells of zero or more"},
                          {"another value in row ", bad / description().columns + 1, ", column ",
                           bad % description().columns + 1}),
                   false;
        at_ += frame_bytes_, --left_;
        std::optional<double> seconds;
        if (const auto period = description().seconds_per_frame)
            seconds = static_cast<double>(frames()) * *period;
        emit(sink, frames() + 1, seconds);
        return true;
    }

    sensor_description sensor_, first_; ///< of the user, and of the latest head
    std::optional<cell_reader> reader_;
    std::vector<std::byte> bytes_; ///< of the file, from number `byte_` on; used up to `at_`
    std::size_t byte_ = 0, at_ = 0, frame_bytes_ = 0;
    std::uint64_t left_ = 0;  ///< frames after the latest head
    std::size_t largest_ = 0; ///< of their cells, as it states
};

}} // namespace tactnet
