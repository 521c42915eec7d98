#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/text/numbers.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// The lines between which the cells of Tekscan's text stand: what a spreadsheet may have done to any line,
// lines of a header, the ones that end it, and the line that begins a frame.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What may stand between two cells beside blanks.
[[nodiscard]] constexpr bool is_separator(char c) noexcept {
    return c == ',' || c == ';';
}

/// A line without the quotes, the blanks at both ends and the separators at its end that spreadsheets add.
/// `storage` holds it where it cannot be a part of `line`.
[[nodiscard]] inline std::string_view without_decoration(std::string_view line, std::string& storage) {
    if (line.find('"') != std::string_view::npos) {
        storage = line;
        std::erase(storage, '"');
        line = storage;
    }
    while (!line.empty() && (is_separator(line.back()) || detail::is_blank(line.back())))
        line.remove_suffix(1);
    return trimmed(line);
}

/// A line of a header.
struct tekscan_header_line {
    std::string_view key, value; ///< the value may be empty
};

/// Cuts a line, without decoration.
[[nodiscard]] constexpr tekscan_header_line cut_header_line(std::string_view line) noexcept {
    const std::size_t key_end = std::min(line.find_first_of(" \t,;"), line.size());
    tekscan_header_line result{line.substr(0, key_end), line.substr(key_end)};
    while (!result.value.empty() &&
           (is_separator(result.value.front()) || detail::is_blank(result.value.front())))
        result.value.remove_prefix(1);
    return result;
}

/// What comes behind a line of a header.
enum class tekscan_part : std::uint8_t { header, cells, map };

/// 'ASCII_DATA @@' begins cells, 'SENSOR_MAP @@' a map. Free text may begin with the same words.
[[nodiscard]] constexpr tekscan_part part_behind(const tekscan_header_line& line) noexcept {
    if (!line.value.empty() && !line.value.starts_with("@@"))
        return tekscan_part::header;
    return line.key == "ASCII_DATA"   ? tekscan_part::cells
           : line.key == "SENSOR_MAP" ? tekscan_part::map
                                      : tekscan_part::header;
}

/// What the line in front of a frame says.
struct tekscan_frame_line {
    std::uint64_t number = 0;
    std::optional<double> stamp; ///< in `stamp_unit` seconds, or in a unit that the line does not tell
    std::optional<double> stamp_unit;
    std::optional<double> raw_sum;
};

/// Whether a line, without decoration, begins a frame.
[[nodiscard]] constexpr bool begins_frame(std::string_view line) noexcept {
    return line.size() > 5 && same_letters(line.substr(0, 5), "frame") &&
           (detail::is_blank(line[5]) || is_separator(line[5]));
}

/// Reads such a line: 'Frame 1', 'Frame 1, 0.1,, 12/2/2019 6:21:52.34PM,,,Raw Sum=,,310' or 'Frame 1, 100
/// ms'. The time of day is not looked at, since it is written as in the country of the computer. Nothing if
/// there is no frame number, or the time has a decimal comma.
[[nodiscard]] inline std::optional<tekscan_frame_line> scan_frame_line(std::string_view line) {
    line.remove_prefix(5);
    const auto next_field = [&] {
        const std::size_t length = std::min(line.find_first_of(",;\t"), line.size());
        const std::string_view field = trimmed(line.substr(0, length));
        line.remove_prefix(std::min(length + 1, line.size()));
        return field;
    };
    // 'Frame', then the number, with blanks or a separator between them.
    while (!line.empty() && (is_separator(line.front()) || detail::is_blank(line.front())))
        line.remove_prefix(1);
    std::size_t digits = 0;
    while (digits < line.size() && detail::is_digit(line[digits]))
        ++digits;
    const auto number = whole_number(line.substr(0, digits));
    if (!number || (digits < line.size() && !is_separator(line[digits]) && !detail::is_blank(line[digits]) &&
                    line[digits] != ':'))
        return std::nullopt;
    line.remove_prefix(std::min(digits + 1, line.size()));

    tekscan_frame_line result{*number, {}, {}, {}};
    bool after_sum = false, after_stamp = false;
    while (!line.empty()) {
        std::string_view field = next_field();
        if (field.empty()) {
            after_stamp = false;
            continue;
        }
        constexpr std::string_view sum = "raw sum";
        if (field.size() >= sum.size() && same_letters(field.substr(0, sum.size()), sum)) {
            after_sum = true;
            field = trimmed(field.substr(std::min(field.find('=') + 1, field.size())));
        }
        // Frames from before a trigger may have times below zero.
        const bool below_zero = !after_sum && field.front() == '-';
        const auto found = scan_measure(field.substr(below_zero ? 1 : 0));
        if (after_sum) {
            if (found && found->unit.empty() && !result.raw_sum)
                result.raw_sum = found->number;
        } else if (!result.stamp && found) {
            const auto unit = unit_size(time_units, found->unit);
            if (!unit && !found->unit.empty())
                continue; // a date
            result.stamp = below_zero ? -found->number : found->number;
            result.stamp_unit = unit;
            after_stamp = !unit;
        } else if (after_stamp) {
            if (whole_number(field))
                return std::nullopt; // '0,1': a decimal comma
            result.stamp_unit = unit_size(time_units, field);
            after_stamp = false;
        }
    }
    return result;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
