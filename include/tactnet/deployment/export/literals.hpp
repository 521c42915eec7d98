#pragma once

#include <tactnet/detail/config.hpp>

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

// Values as the text of a C++ header.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A string literal, with bytes beyond ASCII and special characters as octal numbers.
inline std::string string_literal(std::string_view text) {
    std::string literal = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\' || c == '?') // ?: trigraphs
            (literal += '\\') += c;
        else if (code >= 0x20 && code < 0x7f)
            literal += c;
        else
            for (literal += '\\'; const int shift : {6, 3, 0})
                literal += static_cast<char>('0' + ((code >> shift) & 7));
    }
    return literal + '"';
}

/// A text for a comment of one line, without characters that could end it.
inline std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == '\\')
            c = ' ';
    return text;
}

/// A number in hexadecimal, which is exact and as quick to compile as decimal numbers.
template <std::floating_point Number>
std::string literal(Number value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof(text), std::abs(value), std::chars_format::hex);
    return (std::signbit(value) ? "-0x" : "0x") + std::string(text, end.ptr) +
           (std::same_as<Number, float> ? "f" : "");
}

/// Numbers separated by commas, in lines of about a hundred characters.
template <class Number>
std::string number_lines(std::span<const Number> numbers, std::string (*text_of)(Number)) {
    std::string lines, line = "   ";
    for (const Number number : numbers) {
        const std::string text = text_of(number);
        if (line.size() + text.size() > 108) {
            lines += line + "\n";
            line = "   ";
        }
        line += " " + text + ",";
    }
    return lines + line + "\n";
}

/// Parts of a text, one after the other, with every @name@ replaced by its value.
using replacement = std::pair<std::string_view, std::string>;
inline std::string filled(std::initializer_list<std::string_view> parts,
                          std::span<const replacement> values) {
    std::string result;
    for (std::string_view text : parts)
        while (true) {
            const std::size_t begin = text.find('@');
            result += text.substr(0, begin);
            if (begin == std::string_view::npos)
                break;
            const std::size_t end = text.find('@', begin + 1);
            const std::string_view name = text.substr(begin + 1, end - begin - 1);
            for (const replacement& value : values)
                if (value.first == name)
                    result += value.second;
            text.remove_prefix(end + 1);
        }
    return result;
}

}}} // namespace tactnet::detail
