#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/described/cell_reader.hpp>
#include <tactnet/sensors/described/description.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

// Lines of numbers: what a sketch of a microcontroller prints, and tables as files (CSV, TSV).

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Reads the fields of a line, between commas, semicolons, tabs and spaces. Several spaces are one separator,
/// and one may follow the last field.
class field_scanner {
public:
    /// `end` points to a character that is no part of a number.
    field_scanner(std::string_view line, bool decimal_comma) noexcept
        : at_(line.data()),
          end_(line.data() + line.size()),
          decimal_comma_(decimal_comma),
          separator_(decimal_comma ? ';' : ',') {
        skip_blanks();
    }

    /// Whether there are no more fields.
    [[nodiscard]] bool at_end() const noexcept { return at_ == end_; }
    [[nodiscard]] std::string_view rest() const noexcept {
        return {at_, static_cast<std::size_t>(end_ - at_)};
    }

    /// Reads a number of any kind. Returns false, and stays there, if there is none.
    [[nodiscard]] bool number(double& value) noexcept {
        // Nearly all are up to seven digits, followed by the separator before and another digit.
        if (std::endian::native == std::endian::little && end_ - at_ > 8) {
            std::uint64_t bytes;
            std::memcpy(&bytes, at_, sizeof(bytes));
            bytes ^= 0x3030303030303030U; // of a digit, its value
            const std::uint64_t others =
                ((bytes + 0x7676767676767676U) | bytes) & 0x8080808080808080U; // right up to the first
            const int digits = std::countr_zero(others) / 8;
            if (digits >= 1 && digits <= 7 && at_[digits] == separator_ && is_digit(at_[digits + 1])) {
                bytes <<= 64 - 8 * digits;
                bytes = bytes * 10 + (bytes >> 8U); // in every second byte, two digits
                value = static_cast<std::uint32_t>(((bytes & 0xFF000000FFU) * 0xF424000000064U +
                                                    (bytes >> 16U & 0xFF000000FFU) * 0x271000000001U) >>
                                                   32U);
                at_ += digits + 1;
                return true;
            }
        }
        const char* at = at_;
        std::uint32_t digits = 0;
        for (unsigned digit; (digit = static_cast<unsigned>(*at) - '0') <= 9 && at - at_ < 9; ++at)
            digits = digits * 10 + digit;
        if (at != at_ && skip_separator(at)) {
            value = digits;
            return true;
        }
        return any_number(value);
    }
    /// Skips a field of any kind, such as a label, which may end with a colon.
    void skip() noexcept {
        while (at_ != end_ && !is_separator(*at_) && *at_ != ':')
            ++at_;
        if (at_ != end_ && *at_ == ':')
            ++at_, skip_blanks();
        else
            static_cast<void>(skip_separator(at_));
    }

private:
    [[nodiscard]] bool is_separator(char c) const noexcept {
        return c == ';' || c == '\t' || c == ' ' || (c == ',' && !decimal_comma_);
    }
    void skip_blanks() noexcept {
        while (at_ != end_ && *at_ == ' ')
            ++at_;
    }
    /// Moves behind the separator at `at`, and returns whether there is one or the end of the line.
    [[nodiscard]] bool skip_separator(const char* at) noexcept {
        if (at == end_) {
            at_ = at;
            return true;
        }
        if (!is_separator(*at))
            return false;
        const bool blank = *at == ' ';
        separator_ = *at;
        at_ = at + 1;
        if (at_ != end_ && (blank || *at_ == ' ')) {
            skip_blanks();
            if (blank && at_ != end_ && *at_ != ' ' && is_separator(*at_))
                ++at_, skip_blanks();
        }
        return true;
    }

    [[gnu::noinline]] bool any_number(double& value) noexcept {
        const char* at = at_;
        const bool negative = at != end_ && *at == '-';
        if (at != end_ && (*at == '-' || *at == '+'))
            ++at;
        const std::string_view left(at, static_cast<std::size_t>(end_ - at));
        if (left.size() >= 3 &&
            (same_letters(left.substr(0, 3), "nan") || same_letters(left.substr(0, 3), "inf"))) {
            value = same_letters(left.substr(0, 3), "nan") ? std::numeric_limits<double>::quiet_NaN()
                                                           : std::numeric_limits<double>::infinity();
            at += 3;
        } else {
            const scanned_number scanned = scan_number(at, end_);
            if (scanned.end == nullptr)
                return false;
            value = scanned.value;
            at = scanned.end;
            if (decimal_comma_ && at != end_ && *at == ',' && whole(left.data(), at)) {
                const scanned_number fraction = scan_number(at + 1, end_);
                if (fraction.end == nullptr || !whole(at + 1, fraction.end) || fraction.end - at > 15)
                    return false;
                value += fraction.value / exact_tens[static_cast<std::size_t>(fraction.end - at - 1)];
                at = fraction.end;
            }
        }
        if (negative)
            value = -value;
        return skip_separator(at);
    }
    [[nodiscard]] static bool whole(const char* at, const char* end) noexcept {
        while (at != end && is_digit(*at))
            ++at;
        return at == end;
    }

    const char* at_;
    const char* end_;
    bool decimal_comma_;
    char separator_; ///< the latest
};

} // namespace detail

/// Decodes lines of numbers of a described array: a frame a line, or a row a line, perhaps with blank lines
/// between frames. Numbers are separated by commas, semicolons, tabs or spaces; one separator may follow the
/// last. A stream may be joined at any byte: lines that do not fit are skipped until one fits. After that, a
/// line that does not fit is reported as damaged, and decoding continues at the next line (of rows: after the
/// next blank line, or at the next row if there are none).
///
/// A digit that is lost within a number cannot be seen. Memory: two frames of four bytes per cell, and one
/// line.
class text_stream : public decoder_base {
public:
    /// Throws std::invalid_argument for a description that cannot be, or of other cells than digits.
    explicit text_stream(const sensor_description& description)
        : decoder_base(describe(digits(description), "text")),
          description_(description),
          reader_(description) {}

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        set_status(decode_status::reading);
        while (!lines_.push(bytes, [&](const text_line& line) { return read_line(line, sink); })) {
            fail({lines_.byte(),
                  lines_.number(),
                  frames() + 1,
                  detail::joined({"a line of at most ", largest_header_bytes, " bytes"}),
                  "a longer one",
                  {}});
            return status(); // a line cannot be too long for the array and be its own
        }
        return status();
    }

    /// Ends the text. A frame that is not complete is reported, and so is a text without any frame.
    template <class Sink>
    decode_status finish(Sink&& sink) {
        set_status(decode_status::finished);
        lines_.finish([&](const text_line& line) { return read_line(line, sink); });
        if (filled_ > 0)
            report(byte_, line_, {rows(), " rows of a frame"}, {filled_, " of them"});
        else if (frames() == 0 && first_skipped_)
            fail(*first_skipped_);
        filled_ = 0;
        return status();
    }

    /// Number of lines outside of frames after the header.
    [[nodiscard]] std::uint64_t skipped_lines() const noexcept { return skipped_; }

private:
    static const sensor_description& digits(const sensor_description& d) {
        if (d.cell != cell_type::digits)
            detail::throw_invalid_argument({"text_stream: expected cells of digits, found bytes"});
        return d;
    }
    /// Lines of a frame, and cells of a line.
    [[nodiscard]] std::size_t rows() const noexcept {
        return description_.line == line_content::frame ? 1 : description_.rows;
    }
    [[nodiscard]] std::size_t line_cells() const noexcept { return description_.cells() / rows(); }

    template <class Sink>
    bool read_line(const text_line& line, Sink& sink) {
        byte_ = line.byte, line_ = line.number;
        if (line.number <= description_.header_lines)
            return true;
        detail::field_scanner fields(line.text, description_.decimal_comma);
        if (fields.at_end()) {
            if (filled_ > 0)
                misfit({rows(), " rows of a frame"}, {filled_, " before a blank line"});
            filled_ = 0, waiting_ = false;
            return true;
        }
        if (waiting_)
            return true;
        if (filled_ == 0)
            seconds_.reset();
        for (std::size_t field = 0; field < description_.leading_fields; ++field) {
            const std::string_view stamp = fields.rest();
            double ticks = 0;
            if (field > 0 || !description_.seconds_per_tick)
                fields.skip();
            else if (!fields.number(ticks) || !std::isfinite(ticks * *description_.seconds_per_tick))
                return misfit({"a time stamp"}, {detail::quoted{stamp.substr(0, 20)}});
            else if (filled_ == 0)
                seconds_ = ticks * *description_.seconds_per_tick;
        }
        const std::span<float> sent = reader_.sent(cells()).subspan(filled_ * line_cells(), line_cells());
        std::optional<std::pair<double, std::size_t>> bad; // the first, and its field
        for (std::size_t i = 0; i < sent.size(); ++i) {
            double value = 0;
            if (fields.at_end())
                return misfit({sent.size(), " numbers"}, {i});
            if (!fields.number(value))
                return misfit({"a number in field ", i + 1 + description_.leading_fields},
                              {detail::quoted{fields.rest().substr(0, 20)}});
            if (!reader_.count(value, sent[i]) && !bad)
                bad = {value, i + 1 + description_.leading_fields};
        }
        if (!fields.at_end())
            return misfit({sent.size(), " numbers"}, {"more"});
        if (bad) // no line of a header, but of cells
            return misfit({"cells of zero or more"}, {std::to_string(bad->first), " in field ", bad->second},
                          true);
        if (++filled_ < rows())
            return true;
        filled_ = 0;
        reader_.arrange(cells());
        if (!seconds_ && description_.seconds_per_frame)
            seconds_ = static_cast<double>(frames()) * *description_.seconds_per_frame;
        emit(sink, frames() + 1, seconds_);
        return true;
    }

    /// A line that does not fit: damage, unless no frame has come and it may be of a header.
    bool misfit(detail::text_parts expected, detail::text_parts found, bool is_numbers = false) {
        ++skipped_;
        waiting_ = rows() > 1 && filled_ > 0;
        filled_ = 0;
        if (frames() > 0 || is_numbers)
            report(byte_, line_, expected, found);
        else if (!first_skipped_)
            first_skipped_ = {byte_, line_, 1, detail::joined(expected), detail::joined(found), {}};
        return true;
    }
    void report(std::size_t byte, std::size_t line, detail::text_parts expected, detail::text_parts found) {
        fail({byte, line, frames() + 1, detail::joined(expected), detail::joined(found), {}});
    }

    sensor_description description_;
    cell_reader reader_;
    line_splitter lines_;
    std::size_t filled_ = 0; ///< rows of a frame that have been read
    bool waiting_ = false;   ///< for a blank line, after one that did not fit
    std::optional<double> seconds_;
    std::size_t byte_ = 0, line_ = 0;
    std::uint64_t skipped_ = 0;
    std::optional<decoding_error> first_skipped_;
};

}} // namespace tactnet
