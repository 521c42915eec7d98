#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

// The text header of Tekscan's recordings and maps: lines of a key and a value, up to the line that begins
// the data. Versions differ in keys and units. Keys that matter for the cells are checked; all others are
// kept.

namespace tactnet { inline namespace TACTNET_ARCH {

/// An error in a text.
struct tekscan_problem {
    std::string expected, found;
};

/// Fills a description line by line.
class tekscan_header {
public:
    /// Whether UNITS names the unit of the cells, or one to display raw counts in, which may be any.
    enum class unit_of : std::uint8_t { cells, display };

    explicit tekscan_header(unit_of unit = unit_of::cells) : unit_(unit) {}

    /// Takes a line. Returns the error in it, if any; then pop_warning() has what is doubtful in it.
    [[nodiscard]] std::optional<tekscan_problem> push_line(std::string_view line, recording_description& to) {
        bytes_ += line.size() + 1;
        if (bytes_ > largest_header_bytes || ++lines_ > largest_header_lines)
            return tekscan_problem{detail::joined({"a header of at most ", largest_header_bytes,
                                                   " bytes and ", largest_header_lines, " lines"}),
                                   "a longer one"};
        std::string unquoted;
        const tekscan_header_line read = detail::read_header_line(line, unquoted);
        if (read.followed_by != tekscan_part::header)
            return begin_data(read.followed_by, to);
        if (in_block_) {
            push_block_line(read.text, to.header.back().second);
            return std::nullopt;
        }
        const bool may_be_comment = std::exchange(next_is_comment_, false);
        if (read.text.empty())
            return std::nullopt;
        return key_and_value(read, may_be_comment, to);
    }

    /// What is doubtful in the last line, once: a measure that cannot be read and is left empty.
    [[nodiscard]] std::optional<tekscan_problem> pop_warning() {
        return std::exchange(warning_, std::nullopt);
    }

    /// What the next line belongs to: the header or the data.
    [[nodiscard]] tekscan_part next() const noexcept { return part_; }
    /// The factor from written cells to the unit of the description.
    [[nodiscard]] double cell_scale() const noexcept { return cell_scale_; }

    /// Checks the whole header. `take` calls it at the line that begins the data.
    [[nodiscard]] std::optional<tekscan_problem> complete(recording_description& to) const {
        for (const auto& [key, value] : {std::pair("ROWS", to.rows), std::pair("COLS", to.columns)})
            if (value == 0)
                return tekscan_problem{std::string("a line '") + key + "' in the header", "none"};
        if (to.rows > largest_frame_cells / to.columns)
            return tekscan_problem{"at most " + std::to_string(largest_frame_cells) + " cells",
                                   std::to_string(to.rows) + " x " + std::to_string(to.columns)};
        if (first_frame_ && last_frame_) {
            if (*last_frame_ < *first_frame_ || *last_frame_ - *first_frame_ == UINT64_MAX)
                return tekscan_problem{"an END_FRAME not before START_FRAME " + std::to_string(*first_frame_),
                                       std::to_string(*last_frame_)};
            to.frames = *last_frame_ - *first_frame_ + 1;
        }
        return std::nullopt;
    }

private:
    /// Whether the value of a key matters, what was expected of one that makes no sense, and of one that is
    /// left out.
    struct understanding {
        bool needed = true;
        std::string expected{}, doubt{};

        [[nodiscard]] bool done() const { return needed && expected.empty(); }
    };

    static constexpr std::string_view end_mark = "@@";

    std::optional<tekscan_problem> begin_data(tekscan_part next, recording_description& to) {
        auto problem = complete(to);
        if (!problem)
            part_ = next;
        return problem;
    }

    /// Takes text between 'KEY @@' and '@@'.
    void push_block_line(std::string_view text, std::string& to) {
        if (text == end_mark)
            in_block_ = false;
        else
            to.append(to.empty() ? "" : "\n").append(text);
    }

    std::optional<tekscan_problem> key_and_value(const tekscan_header_line& read, bool may_be_comment,
                                                 recording_description& to) {
        const std::string_view key = read.key, value = read.value;
        if (value == end_mark || ((key == "COMMENTS:" || key == "COMMENTS") && value.empty())) {
            in_block_ = !value.empty();
            next_is_comment_ = value.empty();
            if (next_is_comment_)
                comment_ = to.header.size();
            to.header.emplace_back(key, "");
            return std::nullopt;
        }
        // An empty COMMENTS: may be followed by several lines of free text. A line that cannot belong to the
        // header is such text, and so is a line that begins with a key from before the comment.
        const auto before = std::find_if(to.header.begin(), to.header.end(),
                                         [&](const auto& line) { return line.first == key; });
        const bool known = before != to.header.end();
        const bool repeats =
            comment_ && known && before < to.header.begin() + static_cast<std::ptrdiff_t>(*comment_);
        understanding how = repeats ? understanding{false} : understand(key, value, to);
        if (may_be_comment && !how.done()) {
            to.header.back().second = read.text;
            return std::nullopt;
        }
        if (how.done() && !how.doubt.empty())
            warning_ = tekscan_problem{std::move(how.doubt), in_quotes(key) + " " + in_quotes(value)};
        if (!how.expected.empty()) {
            if (!comment_ || value.find(' ') == std::string_view::npos)
                return tekscan_problem{std::move(how.expected), in_quotes(key) + " " + in_quotes(value)};
            to.header[*comment_].second.append("\n").append(read.text);
            return std::nullopt;
        }
        if (how.done() && known && before->second != value)
            return tekscan_problem{"one line " + in_quotes(key),
                                   in_quotes(before->second) + " and " + in_quotes(value)};
        to.header.emplace_back(key, value);
        return std::nullopt;
    }

    /// Takes the value of a key that matters.
    understanding understand(std::string_view key, std::string_view value, recording_description& to) {
        if (key == "ROWS" || key == "COLS") {
            const auto size = whole_number(value).value_or(0);
            if (size == 0 || size > largest_frame_cells)
                return {true, "a number of rows or columns from 1 to " + std::to_string(largest_frame_cells)};
            (key == "ROWS" ? to.rows : to.columns) = static_cast<std::size_t>(size);
        } else if (key == "START_FRAME" || key == "END_FRAME") {
            const auto number = whole_number(value);
            if (!number)
                return {true, "the number of a frame"};
            (key == "START_FRAME" ? first_frame_ : last_frame_) = number;
        } else if (key == "ROW_SPACING") {
            return to_base(value, length_units, {}, largest_length, to.row_spacing);
        } else if (key == "COL_SPACING") {
            return to_base(value, length_units, {}, largest_length, to.column_spacing);
        } else if (key == "SENSEL_AREA") {
            return to_base(value, area_units, {}, largest_length * largest_length, to.cell_area);
        } else if (key == "SATURATION_PRESSURE") {
            return to_base(value, pressure_units, {}, largest_pressure, to.saturation_pressure);
        } else if (key == "SECONDS_PER_FRAME") {
            return to_base(value, time_units, 1, largest_time, to.seconds_per_frame);
        } else if (key == "NOISE_THRESHOLD") {
            return to_base(value, {}, 1, largest_count, to.noise_threshold, 0);
        } else if (key == "UNITS" && unit_ == unit_of::cells) {
            const auto size = unit_size(pressure_units, value);
            if (!size && !detail::same_letters(value, "raw"))
                return {true, "raw or a unit of pressure such as kPa, MPa, PSI, bar, mmHg, N/cm2 or kg/cm2"};
            to.unit = size ? pressure_unit::pascal : pressure_unit::raw;
            cell_scale_ = size.value_or(1);
        } else {
            if (key == "VERSION")
                to.version = value;
            return {false};
        }
        return {};
    }

    // Beyond these no array is built, and no recording is made.
    static constexpr double largest_length = 1, largest_pressure = 1e9, largest_time = 1e6,
                            largest_count = 1e9;
    static constexpr double smallest_measure = 1e-12;

    /// Converts a measure to base units. Without a unit it is in `plain` base units. An unknown unit, no
    /// number or value, or one beyond [least, most] leaves it empty, with a doubt; only an ambiguous number
    /// is an error.
    static understanding to_base(std::string_view value, std::span<const measure_unit> units,
                                 std::optional<double> plain, double most, std::optional<double>& to,
                                 double least = smallest_measure) {
        to.reset();
        const auto found = scan_measure(value);
        if (!found && !value.empty() && detail::is_digit(value.front()))
            return {true, "a number with a decimal point, if any"};
        const auto size = !found ? std::nullopt : found->unit.empty() ? plain : unit_size(units, found->unit);
        if (size && found->number * *size >= least && found->number * *size <= most)
            to = found->number * *size;
        else
            return {true,
                    {},
                    detail::joined({"a measure from ", shortest_text(least), " to ", shortest_text(most),
                                    " in a unit that is known"})};
        return {};
    }

    std::optional<std::uint64_t> first_frame_, last_frame_;
    std::optional<tekscan_problem> warning_;
    double cell_scale_ = 1;
    std::size_t bytes_ = 0, lines_ = 0;
    bool in_block_ = false, next_is_comment_ = false;
    std::optional<std::size_t> comment_; ///< index of the last line COMMENTS:
    unit_of unit_;
    tekscan_part part_ = tekscan_part::header;
};

}} // namespace tactnet
