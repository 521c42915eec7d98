#pragma once

#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// A line of Tekscan's text is read once: `detail::read_header_line` and `read_data_line` return what it is
// and what it contains, whatever quotes, blanks and separators a spreadsheet has added. Only rows are left to
// row.hpp.

namespace tactnet { inline namespace TACTNET_ARCH {

/// What follows a line of a header.
enum class tekscan_part : std::uint8_t { header, cells, map };

/// A line of a header, without decoration.
struct tekscan_header_line {
    std::string_view text, key, value;               ///< the value may be empty
    tekscan_part followed_by = tekscan_part::header; ///< 'ASCII_DATA @@' begins cells, 'SENSOR_MAP @@' a map
};

/// The contents of a line that begins a frame.
struct tekscan_frame_line {
    std::uint64_t number = 0;
    std::optional<double> stamp;      ///< the time, in units of `stamp_unit`
    std::optional<double> stamp_unit; ///< seconds; empty if the line names no unit
    std::optional<double> raw_sum;
    bool names_sum = false;      ///< whether it has the words Raw Sum, with a number or without
    bool unnamed_number = false; ///< whether it ends with a number that nothing names
};

/// What a line after the header is. A row that does not begin with a digit or B is `other` at first.
enum class tekscan_line_kind : std::uint8_t { row, frame, blank, end_mark, end_of_data, other };

/// A line after the header.
struct tekscan_line {
    text_line source;      ///< as it stands in the recording
    std::string_view text; ///< without decoration; a row keeps its quotes
    tekscan_line_kind kind = tekscan_line_kind::end_of_data;
    std::optional<tekscan_frame_line> frame{}; ///< empty if a line of kind `frame` makes no sense

    /// The line in an error message.
    [[nodiscard]] std::string shown(std::size_t limit = 20) const {
        return kind == tekscan_line_kind::end_of_data ? "the end of the data" : in_quotes(text, limit);
    }
};

namespace detail {

/// Whether `c` separates cells, other than a blank.
[[nodiscard]] constexpr bool is_separator(char c) noexcept {
    return c == ',' || c == ';';
}

/// Removes what spreadsheets add to a line: quotes, blanks at both ends, separators at its end. `unquoted`
/// holds the text if the line has quotes.
[[nodiscard]] inline std::string_view without_decoration(std::string_view line, std::string& unquoted) {
    if (line.find('"') != std::string_view::npos) {
        unquoted = line;
        std::erase(unquoted, '"');
        line = unquoted;
    }
    while (!line.empty() && (is_separator(line.back()) || is_blank(line.back())))
        line.remove_suffix(1);
    return trimmed(line);
}

/// Cuts a line of a header into key and value, which point into `line` or `unquoted`.
[[nodiscard]] inline tekscan_header_line read_header_line(std::string_view line, std::string& unquoted) {
    const std::string_view text = without_decoration(line, unquoted);
    const std::size_t key_end = std::min(text.find_first_of(" \t,;"), text.size());
    tekscan_header_line result{text, text.substr(0, key_end), text.substr(key_end)};
    while (!result.value.empty() && (is_separator(result.value.front()) || is_blank(result.value.front())))
        result.value.remove_prefix(1);
    // Free text may begin with the same words.
    if (result.value.empty() || result.value.starts_with("@@"))
        result.followed_by = result.key == "ASCII_DATA"   ? tekscan_part::cells
                             : result.key == "SENSOR_MAP" ? tekscan_part::map
                                                          : tekscan_part::header;
    return result;
}

/// Reads what follows the word Frame: ' 1', ' 1, 0.1,, 12/2/2019 6:21:52.34PM,,,Raw Sum=,,310' or ' 1, 100
/// ms'. The time of day is ignored, since its format depends on the country. Returns nothing if there is no
/// frame number, or if the time has a decimal comma. A sum that cannot be read is left empty.
[[nodiscard]] inline std::optional<tekscan_frame_line> scan_frame_line(std::string_view rest) {
    const auto next_field = [&] {
        const std::size_t length = std::min(rest.find_first_of(",;\t"), rest.size());
        const std::string_view field = trimmed(rest.substr(0, length));
        rest.remove_prefix(std::min(length + 1, rest.size()));
        return field;
    };
    while (!rest.empty() && (is_separator(rest.front()) || is_blank(rest.front())))
        rest.remove_prefix(1);
    std::size_t digits = 0;
    while (digits < rest.size() && is_digit(rest[digits]))
        ++digits;
    const auto number = whole_number(rest.substr(0, digits));
    if (!number || (digits < rest.size() && !is_separator(rest[digits]) && !is_blank(rest[digits]) &&
                    rest[digits] != ':'))
        return std::nullopt;
    rest.remove_prefix(std::min(digits + 1, rest.size()));

    tekscan_frame_line result{*number, {}, {}, {}};
    bool after_stamp = false;
    while (!rest.empty()) {
        std::string_view field = next_field();
        if (field.empty()) {
            after_stamp = false;
            continue;
        }
        constexpr std::string_view sum = "raw sum";
        if (field.size() >= sum.size() && same_letters(field.substr(0, sum.size()), sum)) {
            result.names_sum = true;
            field = trimmed(field.substr(std::min(field.find('=') + 1, field.size())));
        }
        // Frames before a trigger may have negative times.
        const bool negative = !result.names_sum && field.starts_with('-');
        const auto found = scan_measure(field.substr(negative ? 1 : 0));
        result.unnamed_number = false;
        if (result.names_sum) {
            if (found && found->unit.empty() && !result.raw_sum)
                result.raw_sum = found->number;
        } else if (!result.stamp && found) {
            const auto unit = unit_size(time_units, found->unit);
            if (!unit && !found->unit.empty())
                continue; // a date
            result.stamp = negative ? -found->number : found->number;
            result.stamp_unit = unit;
            after_stamp = !unit;
        } else if (after_stamp) {
            if (whole_number(field))
                return std::nullopt; // '0,1': a decimal comma
            result.stamp_unit = unit_size(time_units, field);
            after_stamp = false;
        } else {
            result.unnamed_number = found && found->unit.empty();
        }
    }
    return result;
}

/// Reads a line after the header. Rows, which are most lines, are recognised by their first letter alone.
[[nodiscard]] inline tekscan_line read_data_line(const text_line& line, std::string& unquoted) {
    using kind = tekscan_line_kind;
    if (!line.text.empty() && (is_digit(line.text[0]) || line.text[0] == 'B'))
        return {line, line.text, kind::row};
    const std::string_view text = without_decoration(line.text, unquoted);
    // Some systems end text files with a control character.
    if (text.empty() || text == "\x1A")
        return {line, text, kind::blank};
    if (text == "@@")
        return {line, text, kind::end_mark};
    constexpr std::string_view frame = "frame";
    if (text.size() > frame.size() && same_letters(text.substr(0, frame.size()), frame) &&
        (is_blank(text[frame.size()]) || is_separator(text[frame.size()])))
        return {line, text, kind::frame, scan_frame_line(text.substr(frame.size()))};
    return {line, text, kind::other};
}

} // namespace detail

/// Computes when the frames of a text recording were taken. A time without a unit is in seconds, unless
/// SECONDS_PER_FRAME of the header shows it to be in milliseconds. Frames without a time are
/// SECONDS_PER_FRAME apart.
class tekscan_frame_times {
public:
    /// Sets the first frame line of the recording.
    void begin(const tekscan_frame_line& first) { first_ = first; }

    /// The time of a frame after `earlier` others, where `each` is SECONDS_PER_FRAME.
    [[nodiscard]] std::optional<double> seconds(const tekscan_frame_line& frame, std::uint64_t earlier,
                                                std::optional<double> each) {
        if (!frame.stamp) {
            if (!each)
                return std::nullopt;
            return static_cast<double>(frame.number - first_.number) * *each;
        }
        if (frame.stamp_unit)
            return *frame.stamp * *frame.stamp_unit;
        // A time step beyond the geometric mean of a second and a millisecond is in milliseconds.
        const std::uint64_t steps = frame.number - (earlier > 0 ? first_.number : 1);
        const double since = *frame.stamp - (earlier > 0 ? first_.stamp.value_or(0) : 0);
        if (!plain_unit_ && since > 0 && steps > 0 && each.value_or(0) > 0)
            plain_unit_ = since / (static_cast<double>(steps) * *each) > std::sqrt(1000.0) ? 1e-3 : 1.0;
        return *frame.stamp * plain_unit_.value_or(1);
    }

private:
    tekscan_frame_line first_;
    std::optional<double> plain_unit_; ///< seconds per unit of a time without a unit, once known
};

}} // namespace tactnet
