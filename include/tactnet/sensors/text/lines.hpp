#pragma once

#include <tactnet/sensors/decoder.hpp>

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

// Splits text that arrives in pieces into lines that end with LF or CR LF. Only a line split between pieces
// is copied.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A line without its end.
struct text_line {
    /// The character after the last one may be read, and is a line end or NUL.
    std::string_view text;
    std::size_t byte = 0;   ///< offset of its start
    std::size_t number = 0; ///< from 1
    bool ended = true;      ///< false for a last line without a line end
};

/// What a text is instead of lines of single bytes that end with a line feed, by its first bytes; empty if it
/// may be such lines.
[[nodiscard]] inline std::string_view foreign_text(std::string_view begin) noexcept {
    if (begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF") ||
        (begin.size() > 1 && (begin[0] == '\0') != (begin[1] == '\0')))
        return "text in UTF-16: save it as UTF-8";
    const std::size_t end = begin.find_first_of("\r\n");
    if (end != std::string_view::npos && begin[end] == '\r' && begin.find('\n') == std::string_view::npos)
        return "carriage returns without line feeds: save it with the line ends of Windows or Unix";
    return {};
}

/// Splits bytes into lines.
class line_splitter {
public:
    /// Calls take(text_line) for each line that has ended, until it returns false. Returns false if `take`
    /// did, or if a line is longer than largest_header_bytes (see `too_long`).
    template <class Take>
    bool push(std::span<const std::byte> bytes, Take&& take) {
        const char* at = reinterpret_cast<const char*>(bytes.data());
        const char* const end = at + bytes.size();
        while (at != end) {
            const auto* newline =
                static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
            const char* const stop = newline != nullptr ? newline : end;
            if (started_.size() + static_cast<std::size_t>(stop - at) > largest_header_bytes) {
                too_long_ = true;
                return false;
            }
            if (newline == nullptr) {
                started_.append(at, end);
                return true;
            }
            bool go_on = false;
            if (started_.empty()) {
                go_on = emit(std::string_view(at, static_cast<std::size_t>(stop - at)), take);
            } else {
                started_.append(at, stop);
                go_on = emit(started_, take);
                started_.clear();
            }
            at = newline + 1;
            if (!go_on)
                return false;
        }
        return true;
    }

    /// Takes the text after the last line end, if any.
    template <class Take>
    void finish(Take&& take) {
        if (!started_.empty())
            emit(started_, take, false);
        started_.clear();
    }

    [[nodiscard]] bool too_long() const noexcept { return too_long_; }
    /// Offset and number of the line that has not ended.
    [[nodiscard]] std::size_t byte() const noexcept { return byte_; }
    [[nodiscard]] std::size_t number() const noexcept { return number_ + 1; }

private:
    template <class Take>
    bool emit(std::string_view text, Take& take, bool ended = true) {
        text_line line{text, byte_, ++number_, ended};
        byte_ += text.size() + (ended ? 1 : 0);
        while (!line.text.empty() && line.text.back() == '\r')
            line.text.remove_suffix(1);
        constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
        if (number_ == 1 && line.text.starts_with(byte_order_mark))
            line.text.remove_prefix(byte_order_mark.size());
        return take(line);
    }

    std::string started_;
    std::size_t byte_ = 0, number_ = 0;
    bool too_long_ = false;
};

}} // namespace tactnet
