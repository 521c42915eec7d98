#pragma once

#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/text/measures.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

// A row of cells in Tekscan's text: numbers, or B for a cell without a tactel, separated by commas,
// semicolons, tabs or spaces, one kind per row. Nearly all bytes of a recording are read here.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The result of reading a row.
struct tekscan_row_outcome {
    const char* wrong = nullptr;    ///< the place of the error, or null
    const char* expected = nullptr; ///< what was expected there
    std::size_t column = 0;         ///< of that place, counted from 0; cells before it are read
    bool cut = false;               ///< the last number reaches the end of the line
};

namespace detail {

/// Reads a row, cell by cell. The character at the end may be read, and is neither a digit nor a separator.
class row_scanner {
public:
    row_scanner(std::string_view line, double scale)
        : at_(line.data()), end_(line.data() + line.size()), scale_(scale) {}

    tekscan_row_outcome scan(std::span<float> cells, std::span<std::uint8_t> exists, double& sum) {
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
        while (at_ != end_ && (detail::is_separator(*at_) || is_quote_or_blank(*at_)))
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

    /// Reads a number, short integers the fast way. Returns what was expected, or null.
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

    /// Reads the separator between two cells. All separators of a row must be alike, so that a decimal comma
    /// is never taken for one. Returns what was expected, or null.
    const char* gap() {
        if (*at_ == ',' && kind_ == ',') {
            ++at_;
            return nullptr;
        }
        const char* const begin = at_;
        skip_blanks();
        const char found = at_ != end_ && detail::is_separator(*at_) ? *at_ : ' ';
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

/// Reads a row into `cells`, multiplied by `scale`, marks in `exists` which have a tactel, and adds them to
/// `sum`. After the last cell, only separators may follow.
inline tekscan_row_outcome scan_tekscan_row(std::string_view line, double scale, std::span<float> cells,
                                            std::span<std::uint8_t> exists, double& sum) {
    return detail::row_scanner(line, scale).scan(cells, exists, sum);
}

}} // namespace tactnet
