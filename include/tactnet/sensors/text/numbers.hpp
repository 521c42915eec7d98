#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/text/numbers.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

// Numbers as recordings write them: digits with or without a decimal point and an exponent, never a sign,
// since neither counts nor pressures nor lengths are below zero. A decimal comma is nobody's number: it would
// be a guess. Most cells have one to three digits, so these are read by hand; the rest is exact as well.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A number at the start of a text. `end` is behind it, and null if there is none that a double can hold.
struct scanned_number {
    double value = 0;
    const char* end = nullptr;
};

namespace detail {

[[nodiscard]] constexpr bool is_digit(char c) noexcept {
    return static_cast<unsigned char>(c - '0') <= 9;
}
[[nodiscard]] constexpr bool is_blank(char c) noexcept {
    return c == ' ' || c == '\t';
}

/// Powers of ten that a double holds exactly.
inline constexpr auto exact_tens = [] {
    std::array<double, 16> tens{1};
    for (std::size_t i = 1; i < tens.size(); ++i)
        tens[i] = tens[i - 1] * 10;
    return tens;
}();

} // namespace detail

/// Reads the number that [begin, end) starts with, rounded once.
[[nodiscard]] inline scanned_number scan_number(const char* begin, const char* end) noexcept {
    // Up to 15 digits in all, both the digits as a whole number and the power of ten are exact, and one
    // division rounds once.
    constexpr std::ptrdiff_t exact_digits = 15;
    const char* at = begin;
    std::uint64_t digits = 0;
    const auto take_digits = [&] {
        for (; at != end && detail::is_digit(*at); ++at)
            digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
    };
    take_digits();
    const std::ptrdiff_t whole = at - begin;
    std::ptrdiff_t fraction = 0;
    if (at != end && *at == '.') {
        ++at;
        take_digits();
        fraction = at - begin - whole - 1;
    }
    if (whole + fraction == 0)
        return {};
    const bool exponent = at != end && (*at == 'e' || *at == 'E');
    if (!exponent && whole + fraction <= exact_digits)
        return {static_cast<double>(digits) / detail::exact_tens[static_cast<std::size_t>(fraction)], at};
    const auto [value, stop] = read_floating_point<double>(begin, end);
    return {value, stop};
}

/// All of `text` as a whole number; nothing if it is anything else.
[[nodiscard]] inline std::optional<std::uint64_t> whole_number(std::string_view text) noexcept {
    std::uint64_t value = 0;
    const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || code != std::errc() || stop != text.data() + text.size())
        return std::nullopt;
    return value;
}

/// The fewest digits that read as the same number again, without an exponent for what sensors tell.
template <std::floating_point T>
[[nodiscard]] std::string shortest_text(T value) {
    return std::abs(value) < T(1e16) ? fixed_number(value) : shortest_number(value);
}

/// `text` without blanks at both ends.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) noexcept {
    while (!text.empty() && detail::is_blank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && detail::is_blank(text.back()))
        text.remove_suffix(1);
    return text;
}

/// Whether two texts are the same but for the case of their Latin letters.
[[nodiscard]] constexpr bool same_letters(std::string_view a, std::string_view b) noexcept {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    if (a.size() != b.size())
        return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (lower(a[i]) != lower(b[i]))
            return false;
    return true;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
