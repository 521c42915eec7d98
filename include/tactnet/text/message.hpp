#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

// Messages made of texts, whole numbers, and names in quotes, which may come from a hostile or damaged file.

namespace tactnet { inline namespace TACTNET_ARCH {

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

/// Whether a terminal shows `character`, one of well-formed UTF-8, and does nothing else: false for control
/// characters (C0, DEL and C1), ends of lines and paragraphs, and marks of direction.
[[nodiscard]] constexpr bool is_visible(std::string_view character) noexcept {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
    if (character.size() == 1)
        return byte(0) >= 0x20 && byte(0) != 0x7F;
    if (character.size() == 2) // U+0080 to U+009F, of which one begins escape sequences; U+061C
        return !(byte(0) == 0xC2 && byte(1) < 0xA0) && !(byte(0) == 0xD8 && byte(1) == 0x9C);
    // U+200E, U+200F, U+2028 to U+202E and U+2066 to U+2069: lines, paragraphs and directions.
    if (byte(0) == 0xE2 && byte(1) == 0x80)
        return !(byte(2) == 0x8E || byte(2) == 0x8F || (byte(2) >= 0xA8 && byte(2) <= 0xAE));
    return !(byte(0) == 0xE2 && byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9);
}

namespace detail {

/// A text that a message shows as in_quotes does. Unlike the result of in_quotes it needs no string at the
/// place of an error, which would have to be destroyed there.
struct quoted {
    std::string_view text;
};

/// A part of a message: a text, a text in quotes, or a whole number.
struct text_part {
    text_part(const char* part) : text(part) {}
    text_part(std::string_view part) : text(part) {}
    text_part(const std::string& part) : text(part) {}
    text_part(quoted part) : text(part.text), is_quoted(true) {}
    text_part(std::uintmax_t part) : number(part), is_number(true) {}

    std::string_view text;
    std::uintmax_t number = 0;
    bool is_number = false, is_quoted = false;
};
using text_parts = std::initializer_list<text_part>;

/// Appends `text` in single quotes, as in_quotes shows it.
[[gnu::cold, gnu::noinline]] inline void append_quoted(std::string& shown, std::string_view text,
                                                       std::size_t limit) {
    constexpr const char* digits = "0123456789abcdef";
    shown.append("'", 1);
    std::size_t used = 0;
    while (!text.empty() && used < limit) {
        const std::size_t length = utf8_sequence_length(text);
        const std::string_view character = text.substr(0, length == 0 ? 1 : length);
        if (length > 0 && is_visible(character))
            shown.append(character.data(), character.size());
        else
            for (const char c : character) {
                const auto byte = static_cast<unsigned char>(c);
                const char escape[] = {'\\', 'x', digits[byte >> 4], digits[byte & 15U]};
                shown.append(escape, sizeof(escape));
            }
        text.remove_prefix(character.size());
        used += character.size();
    }
    const std::string_view end = text.empty() ? "'" : "…'";
    shown.append(end.data(), end.size());
}

/// Joins the parts of a message. Not inlined, since concatenation would be most of the code at the place of
/// an error.
[[gnu::cold, gnu::noinline]] inline std::string joined(text_parts parts) {
    std::string text;
    for (const text_part& part : parts) {
        if (part.is_quoted) {
            append_quoted(text, part.text, 80);
        } else if (part.is_number) {
            char digits[20]; // of 2^64 - 1
            char* first = digits + sizeof(digits);
            std::uintmax_t rest = part.number;
            do
                *--first = static_cast<char>('0' + rest % 10);
            while ((rest /= 10) != 0);
            text.append(first, static_cast<std::size_t>(digits + sizeof(digits) - first));
        } else {
            text.append(part.text.data(), part.text.size());
        }
    }
    return text;
}

/// Throws std::invalid_argument with the parts as its message.
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void throw_invalid_argument(text_parts parts) {
    throw std::invalid_argument(joined(parts));
}

} // namespace detail

// Text in files and messages: whether bytes are UTF-8, how names are written in JSON headers (which must be
// UTF-8), and how to show a name that may come from a hostile or damaged file in an error message.

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

/// Whether all of `text` is well-formed UTF-8 that a terminal shows (is_visible): what names from files must
/// be.
constexpr bool is_printable(std::string_view text) noexcept {
    while (!text.empty()) {
        const std::size_t length = utf8_sequence_length(text);
        if (length == 0 || !is_visible(text.substr(0, length)))
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

/// `text` in single quotes, safe to print on one line of a terminal: characters that are not visible and
/// bytes that are not UTF-8 appear as `\xNN`. Text longer than `limit` bytes is cut.
[[gnu::cold, gnu::noinline]] inline std::string in_quotes(std::string_view text, std::size_t limit = 80) {
    std::string shown;
    detail::append_quoted(shown, text, limit);
    return shown;
}

/// `text` as a JSON string (RFC 8259). Throws std::invalid_argument when it is not UTF-8.
[[gnu::cold, gnu::noinline]] inline std::string json_string(std::string_view text) {
    if (!is_utf8(text))
        throw std::invalid_argument(
            detail::joined({"tactnet: text in a file must be UTF-8, not ", detail::quoted{text}}));
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

}} // namespace tactnet
