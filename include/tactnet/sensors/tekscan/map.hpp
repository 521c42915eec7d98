#pragma once

#include <tactnet/sensors/tekscan/header.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/text_recording.hpp>
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
class tekscan_map : public text_recording<tekscan_map> {
public:
    tekscan_map() { mutable_description().format = "Tekscan map"; }

    /// The position of each cell's tactel, row by row; `no_place` if it has none.
    [[nodiscard]] std::span<const std::uint16_t> places() const& noexcept { return places_; }
    void places() const&& = delete; // would dangle
    static constexpr std::uint16_t no_place = 0xFFFF;

private:
    friend class text_recording<tekscan_map>;

    [[nodiscard]] bool before_frames() const noexcept { return true; }
    template <class Sink>
    bool end(Sink&) {
        return fail_at(rest(), 0,
                       {header_.next() == tekscan_part::map
                            ? std::to_string(description().cells()) + " places and a closing '@@'"
                            : "a header that ends with 'SENSOR_MAP @@'"},
                       {"the end of the data after ", places_.size(), " places"});
    }

    template <class Sink>
    bool read_line(const text_line& line, Sink&) {
        if (header_.next() == tekscan_part::header) {
            if (auto problem = header_.push_line(line.text, mutable_description()))
                return damage({problem->expected}, {problem->found});
            if (const auto doubt = header_.pop_warning())
                mutable_warnings().add(
                    {line.byte, line.number, 0, warning_text(doubt->expected), warning_text(doubt->found)});
            if (header_.next() == tekscan_part::cells)
                return damage({"a line 'SENSOR_MAP @@'"}, {"a recording"});
            return true;
        }
        std::string unquoted;
        const std::string_view text = detail::without_decoration(line.text, unquoted);
        // After the map, some versions add data of their own.
        if (text.empty() || status() == decode_status::finished)
            return true;
        if (text == "@@")
            return close();
        return push_places(text);
    }

    bool push_places(std::string_view text) {
        while (!text.empty()) {
            const std::size_t length = std::min(text.find_first_of(",; \t"), text.size());
            const std::string_view field = text.substr(0, length);
            text = trimmed(text.substr(length));
            if (!text.empty() && detail::is_separator(text.front()))
                text = trimmed(text.substr(1));
            const auto place = scan_place(field);
            if (!place)
                return damage({"a place from 0 to 65534, or B"}, {in_quotes(field)});
            if (places_.size() == description().cells())
                return damage({description().cells(), " places"}, {"more"});
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

    bool close() {
        if (places_.size() != description().cells())
            return damage({description().cells(), " places"}, {places_.size(), " before '@@'"});
        std::vector<bool> used(no_place);
        for (const std::uint16_t place : places_) {
            if (place == no_place)
                continue;
            if (used[place])
                return damage({"one cell at each place"}, {"two at place ", place});
            used[place] = true;
        }
        mutable_description().mask.resize(places_.size());
        std::transform(places_.begin(), places_.end(), mutable_description().mask.begin(),
                       [](std::uint16_t place) { return static_cast<std::uint8_t>(place != no_place); });
        set_status(decode_status::finished);
        return true;
    }

    tekscan_header header_{tekscan_header::unit_of::display};
    std::vector<std::uint16_t> places_;
};

}} // namespace tactnet
