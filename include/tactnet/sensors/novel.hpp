#pragma once

#include <tactnet/sensors/described/text_stream.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/text_recording.hpp>

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// ASCII exports of novel's pedar (insoles) and pliance (mats): a head, a line "time[secs] 1 2 3 …" with the
// numbers of the sensors, and a frame a line.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Decodes such an export, in pascal. Sensors with consecutive numbers are a row if all such runs are equally
/// long: pedar's insoles are two rows, left and right. Otherwise the frame is a single row.
///
/// Memory: the head, and a frame of four bytes per cell.
class novel_ascii : public text_recording<novel_ascii> {
public:
    novel_ascii() { mutable_description().format = "novel ASCII"; }

private:
    friend class text_recording<novel_ascii>;

    template <class Sink>
    bool read_line(const text_line& line, Sink& sink) {
        const std::string_view text = trimmed(line.text);
        if (text.empty())
            return true;
        if (description().rows == 0)
            return read_head(text);
        detail::field_scanner fields(text, false);
        double seconds = 0;
        if (!fields.number(seconds) || !std::isfinite(seconds) || seconds < 0)
            return damage({"a time in seconds"}, {detail::quoted{text.substr(0, 20)}});
        for (std::size_t i = 0; i < cells().size(); ++i) {
            double value = 0;
            if (fields.at_end() || !fields.number(value))
                return damage({cells().size(), " pressures"},
                              {i, " and then ", detail::quoted{fields.rest().substr(0, 20)}});
            if (!(value >= 0 && value < 1e9))
                return damage({"pressures of zero or more"}, {std::to_string(value)});
            cells()[i] = static_cast<float>(value * unit_);
        }
        if (!fields.at_end())
            return damage({cells().size(), " pressures"}, {"more"});
        emit(sink, frames() + 1, seconds);
        return true;
    }

    bool read_head(std::string_view text) {
        recording_description& d = mutable_description();
        if (text.starts_with("time[secs]"))
            return read_sensors(text);
        if (d.header.size() == largest_header_lines || header_bytes_ + text.size() > largest_header_bytes)
            return damage({"a line 'time[secs] …' in the first ", largest_header_lines, " lines"}, {"none"});
        header_bytes_ += text.size();
        const std::size_t colon = text.find(':');
        d.header.emplace_back(trimmed(text.substr(0, colon)), colon == std::string_view::npos
                                                                  ? std::string_view()
                                                                  : trimmed(text.substr(colon + 1)));
        if (constexpr std::string_view begin = "pressure values in"; text.starts_with(begin)) {
            const auto size = unit_size(pressure_units, trimmed(text.substr(begin.size())));
            if (!size)
                return damage({"a unit of pressure"}, {detail::quoted{text.substr(begin.size())}});
            unit_ = *size;
            d.unit = pressure_unit::pascal;
        }
        if (constexpr std::string_view per = "time per frame [secs]:";
            text.find(per) != std::string_view::npos)
            if (const auto time = scan_measure(text.substr(text.find(per) + per.size()));
                time && time->number > 0)
                d.seconds_per_frame = time->number;
        return true;
    }

    bool read_sensors(std::string_view text) {
        detail::field_scanner fields(text, false);
        fields.skip();
        std::vector<std::size_t> runs;
        std::size_t count = 0;
        for (double number = 0, before = 0; !fields.at_end(); before = number, ++count) {
            if (!fields.number(number) || count == largest_frame_cells)
                return damage({"numbers of sensors, at most ", largest_frame_cells},
                              {detail::quoted{fields.rest().substr(0, 20)}});
            if (runs.empty() || number != before + 1)
                runs.push_back(0);
            ++runs.back();
        }
        if (count == 0)
            return damage({"numbers of sensors"}, {"none"});
        bool equal = true;
        for (const std::size_t run : runs)
            equal = equal && run == runs[0];
        mutable_description().rows = equal ? runs.size() : 1;
        mutable_description().columns = equal ? runs[0] : count;
        resize_cells();
        return true;
    }

    template <class Sink>
    bool end(Sink&) {
        return description().rows > 0 || damage({"a line 'time[secs] …'"}, {"the end of the data"});
    }

    double unit_ = 1;
    std::size_t header_bytes_ = 0;
};

}} // namespace tactnet
