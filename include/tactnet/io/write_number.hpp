#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <type_traits>

// Writing floating-point numbers where the standard library's to_chars may lack them, as libc++'s before
// version 14 does, which some targets still have. In any locale, without the heap but for the text that is
// returned.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

template <class T>
concept written_by_standard_library = requires(char* text, T value) {
    std::to_chars(text, text, value, std::chars_format::fixed);
};

/// In a form of printf, "%.*f" or "%.*e", with as few digits behind the point as read as the same number
/// again. Returns the end, `begin` if it does not fit.
template <std::floating_point T>
char* write_in_form(char* begin, char* end, const char* form, T value) noexcept {
    const auto read_again = [&] {
        if constexpr (std::is_same_v<T, float>)
            return std::strtof(begin, nullptr);
        else
            return std::strtod(begin, nullptr);
    };
    int size = 0;
    for (int digits = 0;; ++digits) {
        size = std::snprintf(begin, static_cast<std::size_t>(end - begin), form, digits,
                             static_cast<double>(value));
        if (size < 0 || size >= end - begin)
            return begin;
        if (read_again() == value)
            break;
    }
    // What the locale has for a point becomes one.
    char* to = begin;
    bool point = false;
    for (const char* from = begin; from != begin + size; ++from) {
        const bool plain = (*from >= '0' && *from <= '9') || *from == '-' || *from == '+' || *from == 'e';
        if (plain || !point)
            *to++ = plain ? *from : '.';
        point = point || !plain;
    }
    return to;
}

} // namespace detail

/// Room for any number in either form: the smallest of all has 324 zeros.
inline constexpr std::size_t number_letters = 400;

/// The fewest letters that read as the same number again, with an exponent where that is shorter, into
/// [begin, end). A finite number. Returns the end; `begin` if there is too little room.
template <std::floating_point T>
char* write_shortest(char* begin, char* end, T value) noexcept {
    if constexpr (detail::written_by_standard_library<T>) {
        const auto [stop, code] = std::to_chars(begin, end, value);
        return code == std::errc() ? stop : begin;
    } else {
        char other[number_letters];
        char* const fixed = detail::write_in_form(begin, end, "%.*f", value);
        const char* const scientific = detail::write_in_form(other, other + sizeof(other), "%.*e", value);
        if (fixed != begin && fixed - begin <= scientific - other)
            return fixed;
        if (scientific - other > end - begin)
            return begin;
        return std::copy(static_cast<const char*>(other), scientific, begin);
    }
}
/// As a text.
template <std::floating_point T>
[[nodiscard]] std::string shortest_number(T value) {
    char text[number_letters];
    return {text, write_shortest(text, text + sizeof(text), value)};
}

/// The fewest digits that read as the same number again, without an exponent. A finite number below 1e16.
template <std::floating_point T>
[[nodiscard]] std::string fixed_number(T value) {
    char text[number_letters];
    if constexpr (detail::written_by_standard_library<T>)
        return {text, std::to_chars(text, text + sizeof(text), value, std::chars_format::fixed).ptr};
    else
        return {text, detail::write_in_form(text, text + sizeof(text), "%.*f", value)};
}

} // namespace TACTNET_ARCH
} // namespace tactnet
