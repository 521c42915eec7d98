#pragma once

// A recording format of your own, as text: a line `grid ROWS COLUMNS`, then frame after frame, each of ROWS
// lines of COLUMNS numbers with blanks between. Copy it, and change what a line of your format is.

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

class grid_text : public tactnet::decoder_base {
public:
    grid_text() : decoder_base({.format = "grid text"}) {}

    /// Bytes as they arrive, split anywhere. A recording that was damaged once stays so.
    template <class Sink>
    tactnet::decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        const auto take = [&](const tactnet::text_line& line) { return read(line, sink); };
        if (status() != tactnet::decode_status::damaged && !lines_.push(bytes, take) && lines_.too_long())
            refuse({.text = {}, .byte = lines_.byte(), .number = lines_.number()}, "a shorter line",
                   "one of more than " + std::to_string(tactnet::largest_header_bytes) + " bytes");
        return status();
    }

    /// No more bytes will come: a last line may lack its end, a last frame may not lack its rows.
    template <class Sink>
    tactnet::decode_status finish(Sink&& sink) {
        if (status() == tactnet::decode_status::damaged)
            return status();
        lines_.finish([&](const tactnet::text_line& line) { return read(line, sink); });
        const tactnet::text_line end{.text = {}, .byte = lines_.byte(), .number = lines_.number()};
        if (status() != tactnet::decode_status::damaged && description().rows == 0)
            refuse(end, "a line 'grid ROWS COLUMNS'", "the end of the data");
        if (status() != tactnet::decode_status::damaged && row_ > 0)
            refuse(end, "row " + std::to_string(row_ + 1) + " of " + std::to_string(description().rows),
                   "the end of the data");
        if (status() != tactnet::decode_status::damaged)
            set_status(tactnet::decode_status::finished);
        return status();
    }

private:
    /// False ends the recording.
    template <class Sink>
    bool read(const tactnet::text_line& line, Sink& sink) {
        if (description().rows == 0)
            return read_header(line);
        if (!read_row(line))
            return false;
        if (++row_ == description().rows) {
            row_ = 0;
            emit(sink, frames() + 1, {});
        }
        return true;
    }

    bool read_header(const tactnet::text_line& line) {
        std::string_view rest = line.text;
        if (word(rest) == "grid") {
            const auto rows = tactnet::whole_number(word(rest)), columns = tactnet::whole_number(word(rest));
            // Announced sizes are bounded before memory is asked for: a damaged byte must not take all of it.
            if (rows && columns && word(rest).empty() && *rows > 0 && *columns > 0 &&
                *rows <= tactnet::largest_frame_cells / *columns) {
                mutable_description().rows = *rows;
                mutable_description().columns = *columns;
                resize_cells();
                return true;
            }
        }
        return refuse(line, "a line 'grid ROWS COLUMNS'", "'" + std::string(line.text.substr(0, 40)) + "'");
    }

    bool read_row(const tactnet::text_line& line) {
        std::string_view rest = line.text;
        for (std::size_t column = 0; column < description().columns; ++column) {
            const std::string_view cell = word(rest);
            const auto number = tactnet::scan_number(cell.data(), cell.data() + cell.size());
            if (cell.empty() || number.end != cell.data() + cell.size())
                return refuse(line, "a number in column " + std::to_string(column + 1),
                              cell.empty() ? "the end of the line" : "'" + std::string(cell) + "'");
            cells()[row_ * description().columns + column] = static_cast<float>(number.value);
        }
        const std::string_view more = word(rest);
        return more.empty() || refuse(line, std::to_string(description().columns) + " numbers", "more");
    }

    /// Takes the next word off a text; empty at its end.
    static std::string_view word(std::string_view& text) {
        text = tactnet::trimmed(text);
        const std::string_view first = text.substr(0, text.find_first_of(" \t"));
        text.remove_prefix(first.size());
        return first;
    }

    bool refuse(const tactnet::text_line& line, std::string expected, std::string found) {
        const std::uint64_t frame = description().rows == 0 ? 0 : frames() + 1;
        fail({line.byte, line.number, frame, std::move(expected), std::move(found)});
        return false;
    }

    tactnet::line_splitter lines_;
    std::size_t row_ = 0; // of the frame that is being read
};
static_assert(tactnet::frame_decoder<grid_text>);
