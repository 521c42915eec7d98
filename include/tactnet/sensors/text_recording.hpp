#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/text/message.hpp>

#include <cstddef>
#include <span>

// What decoders of text recordings share: lines one after the other, up to the first damage.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Base class of decoders of text recordings. A `Format` has `read_line(line, sink)`, which returns false
/// after damage, and `end(sink)`, which returns its status.
template <class Format>
class text_recording : public decoder_base {
public:
    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        if (status() == decode_status::damaged)
            return status();
        const auto take = [&](const text_line& line) {
            place_ = line;
            return self().read_line(line, sink);
        };
        if (!lines_.push(bytes, take) && lines_.too_long())
            return fail({lines_.byte(),
                         lines_.number(),
                         frames() + 1,
                         detail::joined({"a line of at most ", largest_header_bytes, " bytes"}),
                         "a longer one",
                         {}});
        return status();
    }

    template <class Sink>
    decode_status finish(Sink&& sink) {
        if (status() == decode_status::damaged)
            return status();
        lines_.finish([&](const text_line& line) {
            place_ = line;
            return self().read_line(line, sink);
        });
        if (status() == decode_status::damaged)
            return status();
        set_status(decode_status::finished);
        return self().end(sink);
    }

protected:
    text_recording() = default;

    /// Reports damage in the present line. Returns false.
    bool damage(detail::text_parts expected, detail::text_parts found) {
        fail({place_.byte, place_.number, frames() + 1, detail::joined(expected), detail::joined(found), {}});
        return false;
    }

private:
    Format& self() noexcept { return static_cast<Format&>(*this); }

    line_splitter lines_;
    text_line place_{};
};

}} // namespace tactnet
