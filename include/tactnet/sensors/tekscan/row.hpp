#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/text/measures.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

// One row of cells as Tekscan's text has it: numbers, and B where there is no tactel, with commas,
// semicolons, tabs or spaces between them, one kind in a row. This is where nearly all bytes of a recording
// go through.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// How a row was read.
struct row_outcome {
    const char* wrong = nullptr;    ///< the place that makes no sense; null if all does
    const char* expected = nullptr; ///< there
    std::size_t column = 0;         ///< of that place, from 0; cells before it are read
    bool cut = false;               ///< the last number reaches the end of the line
};

namespace detail {

/// Reads one row, cell by cell. `end` may be read, and is neither a digit nor a separator.
class row_scanner {
public:
    row_scanner(std::string_view line, double scale)
        : at_(line.data()), end_(line.data() + line.size()), scale_(scale) {}

    row_outcome scan(std::span<float> cells, std::span<std::uint8_t> exists, double& sum) {
        for (std::size_t column = 0; column < cells.size(); ++column) {
            if (const char* expected = column > 0 ? gap() : nullptr; expected != nullptr)
                return {at_, expected, column};
            if (!is_digit(*at_))
                skip_blanks();
            if (is_digit(*at_) || *at_ == '.') {
                if (const char* expected = number(cells[column]); expected != nullptr)
                    return {at_, expected, column};
                exists[column] = 1;
                sum += static_cast<double>(cells[column]);
            } else if (at_ != end_ && (*at_ == 'B' || *at_ == 'b')) {
                ++at_;
                cells[column] = 0;
                exists[column] = 0;
            } else {
                return {at_, "a number, zero or more, or B", column};
            }
        }
        const bool cut = at_ == end_ && (is_digit(at_[-1]) || at_[-1] == '.');
        while (at_ != end_ && (is_separator(*at_) || is_quote_or_blank(*at_)))
            ++at_;
        if (at_ != end_)
            return {at_, "the end of the row", cells.size()};
        return {nullptr, nullptr, cells.size(), cut};
    }

private:
    static bool is_quote_or_blank(char c) noexcept { return is_blank(c) || c == '"'; }
    void skip_blanks() {
        while (at_ != end_ && is_quote_or_blank(*at_))
            ++at_;
    }

    /// A number in one go where it is short and whole. Returns what was expected, or null.
    const char* number(float& to) {
        std::uint32_t value = 0;
        const char* const begin = at_;
        while (is_digit(*at_))
            value = value * 10 + static_cast<std::uint32_t>(*at_++ - '0');
        if (at_ - begin > 6 || *at_ == '.' || *at_ == 'e' || *at_ == 'E') {
            const scanned_number found = scan_number(begin, end_);
            const double scaled = found.value * scale_;
            if (found.end == nullptr || scaled > static_cast<double>(std::numeric_limits<float>::max())) {
                at_ = begin;
                return "a number that fits";
            }
            at_ = found.end;
            to = static_cast<float>(scaled);
        } else {
            to = static_cast<float>(value * scale_);
        }
        return nullptr;
    }

    /// What stands between two cells. The first gap of a row tells the kind, and all others must be of it: so
    /// a decimal comma never passes for a separator. Returns what was expected, or null.
    const char* gap() {
        if (*at_ == ',' && kind_ == ',') {
            ++at_;
            return nullptr;
        }
        const char* const begin = at_;
        skip_blanks();
        const char found = at_ != end_ && is_separator(*at_) ? *at_ : ' ';
        if (found != ' ') {
            ++at_;
            skip_blanks();
        }
        if (at_ == begin || at_ == end_) {
            return at_ == end_ ? "more cells in this row" : "a comma, semicolon, tab or space between cells";
        }
        if (kind_ != 0 && kind_ != found) {
            at_ = begin;
            return "one kind of separator in a row (and decimal points, not commas)";
        }
        kind_ = found;
        return nullptr;
    }

    const char* at_;
    const char* end_;
    double scale_;
    char kind_ = 0;
};

} // namespace detail

/// Reads as many cells as `cells` has, times `scale`, tells which exist, and adds them to `sum`. What follows
/// them may only be separators.
inline row_outcome scan_tekscan_row(std::string_view line, double scale, std::span<float> cells,
                                    std::span<std::uint8_t> exists, double& sum) {
    return detail::row_scanner(line, scale).scan(cells, exists, sum);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
