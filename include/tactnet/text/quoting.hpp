#pragma once

#include <tactnet/text/message.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

// Text in files and messages: whether bytes are UTF-8, how names are written in JSON headers (which must be
// UTF-8), and how to show a name that may come from a hostile or damaged file in an error message.

namespace tactnet { inline namespace TACTNET_ARCH {

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

/// Why these cannot be the names of classes, with the name; empty if they can. Each must be there once, be
/// UTF-8 and have no control characters.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::string
problem_of_names(std::span<const std::string> names) {
    std::map<std::string, std::string, std::less<>> seen; // a type that headers of files have compiled
    for (const std::string& name : names) {
        if (name.empty())
            return "an empty name";
        if (!is_printable(name))
            return joined({quoted{name}});
        if (!seen.insert({name, std::string()}).second)
            return joined({quoted{name}, " twice"});
    }
    return {};
}
inline constexpr const char* expected_names = "names without control characters, each once";

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
