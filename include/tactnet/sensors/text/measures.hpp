#pragma once

#include <tactnet/text/numbers.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

// Numbers and measures (a number and a unit) as recordings write them. A number has no sign, since counts,
// pressures and lengths are never negative, and no decimal comma, which would be ambiguous. Measures come in
// the spellings of different versions and countries, and become metres, square metres, seconds and pascal.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A number at the start of a text. `end` is where it ends, or null if there is none that a double can hold.
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

/// Reads the number at the start of [begin, end), rounded once. Numbers of up to 15 digits, which nearly all
/// are, are read by hand.
[[nodiscard]] inline scanned_number scan_number(const char* begin, const char* end) noexcept {
    // Up to 15 digits, both the digits as an integer and the power of ten are exact, and the division rounds
    // once.
    constexpr std::ptrdiff_t exact_digits = 15;
    const char* at = begin;
    std::uint64_t digits = 0;
    const auto read_digits = [&] {
        for (; at != end && detail::is_digit(*at); ++at)
            digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
    };
    read_digits();
    const std::ptrdiff_t whole = at - begin;
    std::ptrdiff_t fraction = 0;
    if (at != end && *at == '.') {
        ++at;
        read_digits();
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

/// Parses all of `text` as a whole number. Returns nothing if it is anything else.
[[nodiscard]] inline std::optional<std::uint64_t> whole_number(std::string_view text) noexcept {
    std::uint64_t value = 0;
    const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || code != std::errc() || stop != text.data() + text.size())
        return std::nullopt;
    return value;
}

/// Returns the fewest digits that read as the same number again, without an exponent below 10¹⁶.
template <std::floating_point T>
[[nodiscard]] std::string shortest_text(T value) {
    return std::abs(value) < T(1e16) ? fixed_number(value) : shortest_number(value);
}

/// Removes blanks at both ends of `text`.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) noexcept {
    while (!text.empty() && detail::is_blank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && detail::is_blank(text.back()))
        text.remove_suffix(1);
    return text;
}

/// The spelling of a unit, and its size in base units.
struct measure_unit {
    std::string_view name;
    double size;
};

/// Metres.
inline constexpr measure_unit length_units[] = {
    {"mm", 1e-3},   {"millimeters", 1e-3}, {"millimeter", 1e-3}, {"millimetres", 1e-3}, {"millimetre", 1e-3},
    {"cm", 1e-2},   {"centimeters", 1e-2}, {"centimeter", 1e-2}, {"centimetres", 1e-2}, {"centimetre", 1e-2},
    {"m", 1},       {"meters", 1},         {"meter", 1},         {"metres", 1},         {"metre", 1},
    {"in", 0.0254}, {"inch", 0.0254},      {"inches", 0.0254},
};
/// Square metres.
inline constexpr measure_unit area_units[] = {
    {"mm2", 1e-6},
    {"cm2", 1e-4},
    {"m2", 1},
    {"in2", 0.00064516},
    {"inch2", 0.00064516},
    {"inches2", 0.00064516},
    {"sq mm", 1e-6},
    {"sq cm", 1e-4},
    {"sq m", 1},
    {"sq in", 0.00064516},
    {"square inches", 0.00064516},
};
/// Pascal.
inline constexpr measure_unit pressure_units[] = {
    {"Pa", 1},           {"kPa", 1e3},
    {"MPa", 1e6},        {"psi", 6894.757293168361},
    {"mbar", 100},       {"bar", 1e5},
    {"N/cm2", 1e4},      {"N/mm2", 1e6},
    {"kg/cm2", 98066.5}, {"kgf/cm2", 98066.5},
    {"g/cm2", 98.0665},  {"mmHg", 133.322387415},
    {"atm", 101325},     {"torr", 101325 / 760.},
};
/// Seconds.
inline constexpr measure_unit time_units[] = {
    {"s", 1},     {"sec", 1},     {"secs", 1},           {"second", 1},          {"seconds", 1},
    {"ms", 1e-3}, {"msec", 1e-3}, {"msecs", 1e-3},       {"millisecond", 1e-3},  {"milliseconds", 1e-3},
    {"us", 1e-6}, {"usec", 1e-6}, {"microsecond", 1e-6}, {"microseconds", 1e-6},
};

namespace detail {

/// Whether two texts are equal, ignoring the case of Latin letters.
[[nodiscard]] constexpr bool same_letters(std::string_view a, std::string_view b) noexcept {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    if (a.size() != b.size())
        return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (lower(a[i]) != lower(b[i]))
            return false;
    return true;
}

/// Whether `text` names that unit, ignoring case. A square may be written as 2, ^2 or a superscript in UTF-8
/// or in Windows' western code page.
[[nodiscard]] constexpr bool is_unit(std::string_view text, std::string_view unit) noexcept {
    if (unit.ends_with('2'))
        for (const std::string_view square : {"^2", "\xC2\xB2", "\xB2"})
            if (text.ends_with(square))
                return same_letters(text.substr(0, text.size() - square.size()),
                                    unit.substr(0, unit.size() - 1));
    return same_letters(text, unit);
}

} // namespace detail

/// Returns the size of the unit of that name, which may be in round brackets; nothing if it is unknown.
[[nodiscard]] constexpr std::optional<double> unit_size(std::span<const measure_unit> units,
                                                        std::string_view name) noexcept {
    if (name.size() > 2 && name.front() == '(' && name.back() == ')')
        name = trimmed(name.substr(1, name.size() - 2));
    for (const measure_unit& unit : units)
        if (detail::is_unit(name, unit.name))
            return unit.size;
    return std::nullopt;
}

/// A number and the unit after it, without blanks.
struct scanned_measure {
    double number = 0;
    std::string_view unit; ///< may be empty
};

/// Parses `text` as a measure. Returns nothing if it does not start with a number, or if the number has a
/// decimal comma or a second point.
[[nodiscard]] inline std::optional<scanned_measure> scan_measure(std::string_view text) noexcept {
    text = trimmed(text);
    const char* const end = text.data() + text.size();
    const scanned_number number = scan_number(text.data(), end);
    if (number.end == nullptr)
        return std::nullopt;
    std::string_view rest(number.end, static_cast<std::size_t>(end - number.end));
    if (rest.size() > 1 && (rest[0] == ',' || rest[0] == '.') && detail::is_digit(rest[1]))
        return std::nullopt;
    // A spreadsheet that splits lines at blanks puts a comma between number and unit.
    while (!rest.empty() && (rest.front() == ',' || detail::is_blank(rest.front())))
        rest.remove_prefix(1);
    return scanned_measure{number.value, trimmed(rest)};
}

}} // namespace tactnet
