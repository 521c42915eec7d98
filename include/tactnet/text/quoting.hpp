#pragma once

#include <tactnet/text/message.hpp>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

// Text in files and messages: whether bytes are UTF-8, how names are written in JSON headers (which must be
// UTF-8), and how to show a name that may come from a hostile or damaged file in an error message.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The length in bytes, 1…4, of the well-formed UTF-8 sequence that `text` begins with; 0 if there is none.
/// Overlong forms, surrogates and values above U+10FFFF are not well-formed (Unicode 15, table 3-7).
constexpr std::size_t utf8_sequence_length(std::string_view text) noexcept {
    if (text.empty())
        return 0;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const auto within = [&](std::size_t i, unsigned low, unsigned high) {
        return i < text.size() && byte(i) >= low && byte(i) <= high;
    };
    const unsigned lead = byte(0);
    if (lead < 0x80)
        return 1;
    if (lead >= 0xC2 && lead <= 0xDF)
        return within(1, 0x80, 0xBF) ? 2 : 0;
    if (lead >= 0xE0 && lead <= 0xEF) {
        const unsigned low = lead == 0xE0 ? 0xA0 : 0x80;
        const unsigned high = lead == 0xED ? 0x9F : 0xBF;
        return within(1, low, high) && within(2, 0x80, 0xBF) ? 3 : 0;
    }
    if (lead >= 0xF0 && lead <= 0xF4) {
        const unsigned low = lead == 0xF0 ? 0x90 : 0x80;
        const unsigned high = lead == 0xF4 ? 0x8F : 0xBF;
        return within(1, low, high) && within(2, 0x80, 0xBF) && within(3, 0x80, 0xBF) ? 4 : 0;
    }
    return 0;
}

/// Whether all of `text` is well-formed UTF-8.
constexpr bool is_utf8(std::string_view text) noexcept {
    while (!text.empty()) {
        const std::size_t length = utf8_sequence_length(text);
        if (length == 0)
            return false;
        text.remove_prefix(length);
    }
    return true;
}

namespace detail {

/// Appends the character of a code of at most U+10FFFF.
[[gnu::cold]] inline void append_utf8(std::string& text, std::uint32_t code) {
    const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    const auto rest = [&](unsigned shift) { put(0x80 | ((code >> shift) & 0x3F)); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xC0 | (code >> 6));
        rest(0);
    } else if (code < 0x10000) {
        put(0xE0 | (code >> 12));
        rest(6), rest(0);
    } else {
        put(0xF0 | (code >> 18));
        rest(12), rest(6), rest(0);
    }
}

} // namespace detail

/// `text` in single quotes, safe to print on one line of a terminal: control characters and bytes that are
/// not UTF-8 appear as `\xNN`. Text longer than `limit` bytes is cut.
[[gnu::cold, gnu::noinline]] inline std::string in_quotes(std::string_view text, std::size_t limit = 80) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string shown = "'";
    std::size_t used = 0;
    while (!text.empty() && used < limit) {
        const std::size_t length = utf8_sequence_length(text);
        const auto first = static_cast<unsigned char>(text.front());
        if (length == 0 || first < 0x20 || first == 0x7F) {
            shown += "\\x";
            shown += digits[first >> 4];
            shown += digits[first & 15U];
            text.remove_prefix(1);
            ++used;
        } else {
            shown += text.substr(0, length);
            text.remove_prefix(length);
            used += length;
        }
    }
    return shown + (text.empty() ? "'" : "…'");
}

/// `text` as a JSON string (RFC 8259). Throws std::invalid_argument when it is not UTF-8.
[[gnu::cold, gnu::noinline]] inline std::string json_string(std::string_view text) {
    if (!is_utf8(text))
        throw std::invalid_argument(
            detail::joined({"tactnet: text in a file must be UTF-8, not ", in_quotes(text)}));
    constexpr std::string_view digits = "0123456789abcdef";
    std::string json = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            (json += '\\') += c;
        else if (code < 0x20)
            ((json += "\\u00") += digits[code >> 4]) += digits[code & 15U];
        else
            json += c;
    }
    return json + '"';
}

} // namespace TACTNET_ARCH
} // namespace tactnet
