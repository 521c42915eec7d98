#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/sensors/text/numbers.hpp>

#include <optional>
#include <span>
#include <string_view>

// Measures in the headers of recordings: a number and a unit, in the spellings that programs of different
// versions and countries write. Everything becomes metres, square metres, seconds and pascal.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A spelling, and how many of the base unit it stands for.
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

/// Whether `text` is that unit in any case of its letters. A square may be written 2, ^2 or as a superscript,
/// in UTF-8 or in the one byte of Windows' western code page.
[[nodiscard]] constexpr bool is_unit(std::string_view text, std::string_view unit) noexcept {
    if (unit.ends_with('2'))
        for (const std::string_view square : {"^2", "\xC2\xB2", "\xB2"})
            if (text.ends_with(square))
                return same_letters(text.substr(0, text.size() - square.size()),
                                    unit.substr(0, unit.size() - 1));
    return same_letters(text, unit);
}

/// The size of the unit of that name, in round brackets or not; nothing if unknown.
[[nodiscard]] constexpr std::optional<double> unit_size(std::span<const measure_unit> units,
                                                        std::string_view name) noexcept {
    if (name.size() > 2 && name.front() == '(' && name.back() == ')')
        name = trimmed(name.substr(1, name.size() - 2));
    for (const measure_unit& unit : units)
        if (is_unit(name, unit.name))
            return unit.size;
    return std::nullopt;
}

/// A number and what stands behind it, without blanks.
struct measure {
    double number = 0;
    std::string_view unit; ///< may be empty
};

/// `text` as a measure; nothing if it does not start with a number, or if that has a comma inside or a letter
/// at its end that cannot be told from a unit with certainty.
[[nodiscard]] inline std::optional<measure> scan_measure(std::string_view text) noexcept {
    text = trimmed(text);
    const char* const end = text.data() + text.size();
    const scanned_number number = scan_number(text.data(), end);
    if (number.end == nullptr)
        return std::nullopt;
    std::string_view rest(number.end, static_cast<std::size_t>(end - number.end));
    if (rest.size() > 1 && (rest[0] == ',' || rest[0] == '.') && detail::is_digit(rest[1]))
        return std::nullopt;
    // Where a spreadsheet has split the line at blanks, a comma stands between number and unit.
    while (!rest.empty() && (rest.front() == ',' || detail::is_blank(rest.front())))
        rest.remove_prefix(1);
    return measure{number.value, trimmed(rest)};
}

} // namespace TACTNET_ARCH
} // namespace tactnet
