#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/tekscan/header.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Tekscan's maps of sensors (.mp): a text header, and after 'SENSOR_MAP @@', row by row, the position of each
// cell's tactel in the scan of the electronics: a negative number, 65535 or B for a cell without a tactel.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Decodes a map. It has no frames; its description, with the mask, is complete at the end.
///
/// Memory: three bytes per cell, of at most largest_frame_cells, one line and one header as for
/// tekscan_ascii.
class tekscan_map : public decoder_base {
public:
    tekscan_map() { mutable_description().format = "Tekscan map"; }

    template <class Sink>
    decode_status push(std::span<const std::byte> bytes, Sink&&) {
        if (status() != decode_status::damaged &&
            !lines_.push(bytes, [&](const text_line& line) { return push_line(line); }) && lines_.too_long())
            fail_at(lines_.byte(), lines_.number(), {"a line of at most ", largest_header_bytes, " bytes"},
                    {"a longer one"});
        return status();
    }

    template <class Sink>
    decode_status finish(Sink&&) {
        if (status() != decode_status::damaged)
            lines_.finish([&](const text_line& line) { return push_line(line); });
        if (status() == decode_status::reading)
            fail_at(lines_.byte(), lines_.number(),
                    {header_.next() == tekscan_part::map
                         ? std::to_string(description().cells()) + " places and a closing '@@'"
                         : "a header that ends with 'SENSOR_MAP @@'"},
                    {"the end of the data after ", places_.size(), " places"});
        return status();
    }

    /// The position of each cell's tactel, row by row; `no_place` if it has none.
    [[nodiscard]] std::span<const std::uint16_t> places() const& noexcept { return places_; }
    void places() const&& = delete; // would dangle
    static constexpr std::uint16_t no_place = 0xFFFF;

private:
    bool push_line(const text_line& line) {
        if (header_.next() == tekscan_part::header) {
            if (auto problem = header_.push_line(line.text, mutable_description()))
                return fail_at(line.byte, line.number, {problem->expected}, {problem->found});
            if (const auto doubt = header_.pop_warning())
                mutable_warnings().add(
                    {line.byte, line.number, 0, warning_text(doubt->expected), warning_text(doubt->found)});
            if (header_.next() == tekscan_part::cells)
                return fail_at(line.byte, line.number, {"a line 'SENSOR_MAP @@'"}, {"a recording"});
            return true;
        }
        std::string unquoted;
        const std::string_view text = detail::without_decoration(line.text, unquoted);
        // After the map, some versions add data of their own.
        if (text.empty() || status() == decode_status::finished)
            return true;
        if (text == "@@")
            return end(line);
        return push_places(line, text);
    }

    bool push_places(const text_line& line, std::string_view text) {
        while (!text.empty()) {
            const std::size_t length = std::min(text.find_first_of(",; \t"), text.size());
            const std::string_view field = text.substr(0, length);
            text = trimmed(text.substr(length));
            if (!text.empty() && detail::is_separator(text.front()))
                text = trimmed(text.substr(1));
            const auto place = scan_place(field);
            if (!place)
                return fail_at(line.byte, line.number, {"a place from 0 to 65534, or B"}, {in_quotes(field)});
            if (places_.size() == description().cells())
                return fail_at(line.byte, line.number, {description().cells(), " places"}, {"more"});
            places_.push_back(*place);
        }
        return true;
    }

    static std::optional<std::uint16_t> scan_place(std::string_view field) {
        if (field == "B" || field == "b")
            return no_place;
        const bool negative = field.starts_with('-');
        const auto number = whole_number(field.substr(negative ? 1 : 0));
        if (!number || *number > no_place)
            return std::nullopt;
        return negative ? no_place : static_cast<std::uint16_t>(*number);
    }

    bool end(const text_line& line) {
        if (places_.size() != description().cells())
            return fail_at(line.byte, line.number, {description().cells(), " places"},
                           {places_.size(), " before '@@'"});
        std::vector<bool> used(no_place);
        for (const std::uint16_t place : places_) {
            if (place == no_place)
                continue;
            if (used[place])
                return fail_at(line.byte, line.number, {"one cell at each place"}, {"two at place ", place});
            used[place] = true;
        }
        mutable_description().mask.resize(places_.size());
        std::transform(places_.begin(), places_.end(), mutable_description().mask.begin(),
                       [](std::uint16_t place) { return static_cast<std::uint8_t>(place != no_place); });
        set_status(decode_status::finished);
        return true;
    }

    bool fail_at(std::size_t byte, std::size_t line, detail::text_parts expected, detail::text_parts found) {
        fail({byte, line, 0, detail::joined(expected), detail::joined(found)});
        return false;
    }

    line_splitter lines_;
    tekscan_header header_{tekscan_header::unit_of::display};
    std::vector<std::uint16_t> places_;
};

}} // namespace tactnet
