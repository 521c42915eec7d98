#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/text/message.hpp>

#include <cstddef>
#include <optional>
#include <span>

// What decoders of text recordings share: lines one after the other, up to the first damage.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Base class of decoders of text recordings. A `Format` has `read_line(line, sink)` and, for the end of the
/// data before one of the text, `end(sink)`, which return false after damage.
template <class Format>
class text_recording : public decoder_base {
public:
    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        if (status() != decode_status::damaged && !lines_.push(bytes, reader(sink)) && lines_.too_long())
            fail_at(rest(), 0, {"a line of at most ", largest_header_bytes, " bytes"}, {"a longer one"});
        return status();
    }

    template <class Sink>
    decode_status finish(Sink&& sink) {
        if (status() != decode_status::damaged)
            lines_.finish(reader(sink));
        if (status() == decode_status::reading && self().end(sink))
            set_status(decode_status::finished);
        return status();
    }

protected:
    text_recording() = default;

    /// Whether damage is of no frame, such as in a header.
    [[nodiscard]] bool before_frames() const noexcept { return false; }
    /// Where the line begins that has not ended.
    [[nodiscard]] text_line rest() const noexcept { return {{}, lines_.byte(), lines_.number()}; }

    /// Reports damage in a line. Returns false.
    bool fail_at(const text_line& line, std::size_t column, detail::text_parts expected,
                 detail::text_parts found) {
        const bool in_frame = !self().before_frames();
        fail({line.byte + column, line.number, in_frame ? frames() + 1 : 0, detail::joined(expected),
              detail::joined(found), in_frame ? missing_frames() : std::nullopt});
        return false;
    }
    /// Reports damage in the line that is being read. Returns false.
    bool damage(detail::text_parts expected, detail::text_parts found) {
        return fail_at(place_, 0, expected, found);
    }

private:
    Format& self() noexcept { return static_cast<Format&>(*this); }
    template <class Sink>
    auto reader(Sink& sink) {
        return [&](const text_line& line) {
            place_ = line;
            return self().read_line(line, sink);
        };
    }

    line_splitter lines_;
    text_line place_{};
};

}} // namespace tactnet
