#pragma once

#include <tactnet/sensors/tekscan/header.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/tekscan/row.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/text_recording.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Tekscan's text recordings (.csv, .asf): a header up to 'ASCII_DATA @@', frames of one line and as many rows
// as the header announces, and a closing '@@'. Versions, countries and spreadsheets write them differently.
// Rows, columns, the number of frames, the sum of each frame, if given, and the cells without a tactel are
// checked.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Decodes a text recording. A frame comes out when the next line has been read, which shows that the frame
/// has no further row. Pressures are converted to pascal. Times are those of the frame lines: see
/// tekscan_frame_times.
///
/// Memory: one frame (six bytes per cell, at most largest_frame_cells cells), one line and one header of at
/// most largest_header_bytes and largest_header_lines, the header cut into keys and values.
class tekscan_ascii : public text_recording<tekscan_ascii> {
public:
    tekscan_ascii() { mutable_description().format = "Tekscan ASCII"; }

    /// How many frames have a 'Raw Sum' that is the sum of their cells.
    [[nodiscard]] std::uint64_t matching_sums() const noexcept { return matching_sums_; }

private:
    friend class text_recording<tekscan_ascii>;

    [[nodiscard]] bool before_frames() const noexcept { return header_.next() == tekscan_part::header; }
    template <class Sink>
    bool end(Sink& sink) {
        return push_end({last_, {}, tekscan_line_kind::end_of_data}, sink);
    }

    // Returns false if no more lines are to be read, as do the functions below.
    template <class Sink>
    bool read_line(const text_line& line, Sink& sink) {
        last_ = {{}, line.byte + line.text.size(), line.number};
        if (before_frames())
            return push_header(line);
        const tekscan_line read = detail::read_data_line(line, unquoted_);
        if (read.kind == tekscan_line_kind::blank)
            return true;
        if (status() == decode_status::finished)
            return fail_at(line, 0, {"nothing after the closing @@"}, {read.shown()});
        switch (read.kind) {
        case tekscan_line_kind::row:
            return push_row(line);
        case tekscan_line_kind::frame:
            return push_frame_line(read, sink);
        case tekscan_line_kind::end_mark:
            return push_end(read, sink);
        default:
            // The data end within this line, and the frame is complete without it.
            if (!line.ended && row_ == description().rows)
                return close_frame(read, sink) &&
                       fail_at(line, 0, {"a whole line"}, {"the end of the data after ", read.shown()});
            return push_row(line);
        }
    }

    bool push_header(const text_line& line) {
        if (const auto foreign = foreign_text(line.text); line.number == 1 && !foreign.empty())
            return fail_at(line, 0, {"lines of text in ASCII or UTF-8"}, {foreign});
        if (auto problem = header_.push_line(line.text, mutable_description()))
            return fail_at(line, 0, {problem->expected}, {problem->found});
        if (const auto doubt = header_.pop_warning())
            mutable_warnings().add(
                {line.byte, line.number, 0, warning_text(doubt->expected), warning_text(doubt->found)});
        if (header_.next() == tekscan_part::map)
            return fail_at(line, 0, {"a line 'ASCII_DATA @@'"}, {"a map of a sensor"});
        return true;
    }

    template <class Sink>
    bool push_frame_line(const tekscan_line& line, Sink& sink) {
        if (open_ && !announced_)
            return fail_at(line.source, 0, {"the end after a frame without a line 'Frame'"}, {line.shown()});
        if (open_ && !close_frame(line, sink))
            return false;
        if (!line.frame)
            return fail_at(line.source, 0, {"'Frame', its number and a time with a decimal point, if any"},
                           {line.shown(80)});
        if (announced_ && line.frame->number <= frame_.number)
            return fail_at(line.source, 0, {"a frame after number ", frame_.number},
                           {"number ", line.frame->number});
        warn_of_measures(line.source, *line.frame);
        frame_ = *line.frame;
        if (!announced_)
            times_.begin(frame_);
        announced_ = open_ = true;
        return true;
    }

    /// A sum that cannot be read takes a frame's check away, a time that cannot be read its place in time.
    void warn_of_measures(const text_line& line, const tekscan_frame_line& frame) {
        const auto warn = [&](std::string_view expected, std::string_view found) {
            mutable_warnings().add(
                {line.byte, line.number, frames() + 1, warning_text(expected), warning_text(found)});
        };
        if (frame.names_sum && !frame.raw_sum)
            warn("a number after 'Raw Sum='", "none, so that the cells are not checked");
        else if (!frame.names_sum && frame.unnamed_number)
            warn("'Raw Sum=' before the last number", "other text, so that the cells are not checked");
        else if (announced_ && frame.names_sum != frame_.names_sum)
            warn("a 'Raw Sum' in all frames or in none", frame.names_sum ? "the first one" : "none any more");
        if (announced_ && frame.stamp.has_value() != frame_.stamp.has_value())
            warn("a time in all frames or in none", frame.stamp ? "the first one" : "none any more");
    }

    bool push_row(const text_line& line) {
        const std::size_t rows = description().rows, columns = description().columns;
        if (row_ == rows)
            return fail_at(line, 0, {rows, " rows in a frame"}, {"one more"});
        open_ = true;
        if (exists_.size() < (row_ + 1) * columns) {
            resize_cells((row_ + 1) * columns);
            exists_.resize((row_ + 1) * columns);
        }
        const tekscan_row_outcome outcome =
            scan_tekscan_row(line.text, header_.cell_scale(), cells().subspan(row_ * columns, columns),
                             std::span(exists_).subspan(row_ * columns, columns), sum_);
        if (outcome.wrong != nullptr)
            return refuse_row(line, outcome);
        // A last line that is cut within its last number would be another number. Only a sum can rule that
        // out.
        if (!line.ended && outcome.cut && !checks_sum())
            return fail_at(line, line.text.size(), {"a line end after the last number, which may be cut"},
                           {"the end of the data"});
        cut_ = !line.ended && outcome.cut;
        ++row_;
        return true;
    }

    bool refuse_row(const text_line& line, const tekscan_row_outcome& outcome) {
        const std::size_t columns = description().columns;
        const auto at = static_cast<std::size_t>(outcome.wrong - line.text.data());
        const std::string where =
            outcome.column == columns
                ? " after " + std::to_string(columns) + " columns"
                : " in column " + std::to_string(outcome.column + 1) + " of " + std::to_string(columns);
        const std::string_view rest = line.text.substr(at);
        return fail_at(line, at, {outcome.expected, where},
                       {!rest.empty() ? in_quotes(rest, 20)
                        : line.ended  ? "the end of the line"
                                      : "the end of the data"});
    }

    /// Checks the frame whose rows are read and gives it to the sink. `next` is the line after it.
    template <class Sink>
    bool close_frame(const tekscan_line& next, Sink& sink) {
        if (row_ < description().rows)
            return fail_at(next.source, 0, {description().rows, " rows"}, {row_, " before ", next.shown()});
        if (!sum_matches())
            return fail_at(next.source, 0,
                           {"cells with a sum of ", shortest_text(*frame_.raw_sum), " as the frame says"},
                           {shortest_text(sum_)});
        if (frames() == 0)
            mutable_description().mask = exists_;
        const auto [now, first] = std::mismatch(exists_.begin(), exists_.end(), description().mask.begin());
        if (now != exists_.end()) {
            const auto cell = static_cast<std::size_t>(now - exists_.begin());
            return fail_at(next.source, 0, {"tactels in the same cells as in the first frame"},
                           {*now != 0 ? "a tactel" : "none", " in row ", cell / description().columns + 1,
                            ", column ", cell % description().columns + 1});
        }
        matching_sums_ += checks_sum() ? 1 : 0;
        emit(sink, announced_ ? frame_.number : 1,
             times_.seconds(frame_, frames(), description().seconds_per_frame));
        row_ = 0;
        sum_ = 0;
        open_ = false;
        return true;
    }

    /// Takes the closing line or the end of the data.
    template <class Sink>
    bool push_end(const tekscan_line& line, Sink& sink) {
        if (before_frames())
            return fail_at(line.source, 0, {"a header that ends with 'ASCII_DATA @@'"}, {line.shown()});
        if (open_ && !close_frame(line, sink))
            return false;
        // A single frame without a frame line may be an extract of the recording that the header describes.
        if (!announced_ && frames() == 1)
            mutable_description().frames.reset();
        const std::uint64_t expected = description().frames.value_or(std::max<std::uint64_t>(frames(), 1));
        if (frames() != expected)
            return fail_at(line.source, 0, {expected, " frames"}, {frames(), " before ", line.shown()});
        set_status(decode_status::finished);
        return true;
    }

    /// Whether the frame has a sum to check. Sums are of raw counts, so pressures have none.
    [[nodiscard]] bool checks_sum() const {
        return frame_.raw_sum && description().unit == pressure_unit::raw;
    }
    /// Compares the sums. If cells have decimals, each may be rounded by 0.05, and the sum by 0.5. A last
    /// line that may be cut gets no such allowance.
    [[nodiscard]] bool sum_matches() {
        if (!checks_sum() || sum_ == *frame_.raw_sum)
            return true;
        const auto all = cells();
        if (cut_ || std::all_of(all.begin(), all.end(), [](float c) { return c == std::floor(c); }))
            return false;
        const auto pressed = std::count_if(all.begin(), all.end(), [](float c) { return c > 0; });
        return std::abs(sum_ - *frame_.raw_sum) <= 0.5 + 0.05 * static_cast<double>(pressed);
    }

    tekscan_header header_;
    tekscan_frame_line frame_;
    tekscan_frame_times times_;
    text_line last_;       ///< the end of the last line
    std::string unquoted_; ///< the last line that had quotes, without them
    std::vector<std::uint8_t> exists_;
    std::uint64_t matching_sums_ = 0;
    std::size_t row_ = 0; ///< the next row of the frame
    double sum_ = 0;
    bool cut_ = false;       ///< the last row may lack digits
    bool open_ = false;      ///< a frame has begun
    bool announced_ = false; ///< frames have a line 'Frame'
};

}} // namespace tactnet
