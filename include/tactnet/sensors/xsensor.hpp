#pragma once

#include <tactnet/sensors/described/text_stream.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/text_recording.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// XSENSOR's CSV export: lines of a key and a value, "FRAME", then a block per "SENSOR" with "Rows", "Columns"
// and, after a line "SENSELS", the pressures, a row a line. Groups of cells may follow, which repeat cells.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Decodes such an export, in pascal. The sensors of a frame, of one size, are side by side: the columns of
/// the left insole, then of the right one. A frame is delivered when the next begins.
///
/// Memory: the head, and two frames of four bytes per cell.
class xsensor_csv : public text_recording<xsensor_csv> {
public:
    xsensor_csv() { mutable_description().format = "XSENSOR CSV"; }

private:
    friend class text_recording<xsensor_csv>;

    template <class Sink>
    bool read_line(const text_line& line, Sink& sink) {
        const std::size_t comma = std::min(line.text.find(','), line.text.size());
        const std::string_view key = trimmed(line.text.substr(0, comma));
        std::string_view value = line.text.substr(std::min(comma + 1, line.text.size()));
        while (value.ends_with(','))
            value.remove_suffix(1);
        value = trimmed(value);
        if (key.empty())
            return true;
        if (detail::is_digit(key[0]) || key[0] == '-')
            return in_sensels_ ? read_row(line.text) : true; // of a group
        if (in_sensels_ && rows_read_ < rows_)
            return damage({rows_, " rows of a sensor"}, {rows_read_});
        in_sensels_ = false;
        if (key == "FRAME")
            return begin_frame(value, sink);
        if (key == "SENSOR")
            return begin_sensor();
        if (key == "GROUP")
            in_sensor_ = false;
        else if (key == "SENSELS")
            return begin_sensels();
        else if (key == "Time" && number_)
            seconds_ = seconds_of(value);
        else if (in_sensor_ && (key == "Rows" || key == "Columns"))
            return read_extent(key == "Rows" ? rows_ : columns_, value);
        else if (in_sensor_ && frames() == 0 && (key == "Sensel Width (cm)" || key == "Sensel Height (cm)"))
            if (const auto size = scan_measure(value); size && size->number > 0)
                (key == "Sensel Width (cm)" ? mutable_description().column_spacing
                                            : mutable_description().row_spacing) = size->number / 100;
        return number_ ? true : read_head(key, value);
    }

    bool read_head(std::string_view key, std::string_view value) {
        recording_description& d = mutable_description();
        if (d.header.size() == largest_header_lines ||
            (header_bytes_ += key.size() + value.size()) > largest_header_bytes)
            return damage({"a line 'FRAME' in the first ", largest_header_lines, " lines"}, {"none"});
        d.header.emplace_back(key.ends_with(':') ? key.substr(0, key.size() - 1) : key, value);
        if (key == "Units:") {
            const auto size = unit_size(pressure_units, value);
            if (!size)
                return damage({"a unit of pressure"}, {detail::quoted{value}});
            unit_ = *size;
            d.unit = pressure_unit::pascal;
        }
        return true;
    }
    template <class Sink>
    bool begin_frame(std::string_view value, Sink& sink) {
        if (number_ && !deliver(sink))
            return false;
        number_ = whole_number(value);
        if (!number_)
            return damage({"the number of a frame"}, {detail::quoted{value}});
        gathered_.clear();
        sensors_ = 0;
        in_sensor_ = false;
        return true;
    }
    bool begin_sensor() {
        if (!number_)
            return damage({"a line 'FRAME' before 'SENSOR'"}, {"none"});
        rows_ = columns_ = rows_read_ = 0;
        return in_sensor_ = true;
    }
    bool read_extent(std::size_t& extent, std::string_view value) {
        const auto number = whole_number(value);
        if (!number || *number == 0 || *number > 4096)
            return damage({"1 to 4096 rows or columns"}, {detail::quoted{value}});
        extent = static_cast<std::size_t>(*number);
        return true;
    }
    bool begin_sensels() {
        if (!in_sensor_)
            return true;
        if (rows_ == 0 || columns_ == 0)
            return damage({"'Rows' and 'Columns' before 'SENSELS'"}, {"none"});
        if (sensors_ > 0 && (rows_ != first_rows_ || columns_ != first_columns_))
            return damage({"sensors of ", first_rows_, " x ", first_columns_}, {rows_, " x ", columns_});
        first_rows_ = rows_, first_columns_ = columns_;
        if (gathered_.size() + rows_ * columns_ > largest_frame_cells)
            return damage({"at most ", largest_frame_cells, " cells"}, {"more"});
        rows_read_ = 0;
        ++sensors_;
        return in_sensels_ = true;
    }
    bool read_row(std::string_view text) {
        if (rows_read_ == rows_)
            return damage({rows_, " rows of a sensor"}, {"more"});
        detail::field_scanner fields(text, false);
        for (std::size_t column = 0; column < columns_; ++column) {
            double value = 0;
            if (!fields.number(value) || !(value >= 0 && value < 1e9))
                return damage({columns_, " pressures of zero or more"},
                              {column, " and then ", detail::quoted{fields.rest().substr(0, 20)}});
            gathered_.push_back(static_cast<float>(value * unit_));
        }
        if (fields.rest().find_first_not_of(", \t") != std::string_view::npos)
            return damage({columns_, " pressures"}, {"more"});
        in_sensels_ = ++rows_read_ < rows_;
        in_sensor_ = in_sensels_; // what follows repeats cells
        return true;
    }
    template <class Sink>
    bool deliver(Sink& sink) {
        recording_description& d = mutable_description();
        const std::size_t columns = sensors_ * first_columns_;
        if (gathered_.empty() || gathered_.size() != first_rows_ * columns)
            return damage({"a whole frame"}, {gathered_.size(), " cells of it"});
        if (d.rows == 0) {
            d.rows = first_rows_, d.columns = columns;
            resize_cells();
        }
        if (d.rows != first_rows_ || d.columns != columns)
            return damage({d.rows, " x ", d.columns, " cells"}, {first_rows_, " x ", columns});
        for (std::size_t i = 0; i < gathered_.size(); ++i) {
            const std::size_t sensor = i / (first_rows_ * first_columns_),
                              in_sensor = i % (first_rows_ * first_columns_);
            cells()[in_sensor / first_columns_ * columns + sensor * first_columns_ +
                    in_sensor % first_columns_] = gathered_[i];
        }
        std::optional<double> seconds;
        if (seconds_) {
            first_seconds_ = first_seconds_.value_or(*seconds_);
            seconds = *seconds_ - *first_seconds_;
        }
        emit(sink, *number_, seconds);
        return true;
    }
    template <class Sink>
    bool end(Sink& sink) {
        if (!number_)
            return damage({"a line 'FRAME'"}, {"the end of the data"});
        if (in_sensels_ && rows_read_ < rows_)
            return damage({rows_, " rows of a sensor"}, {rows_read_});
        return deliver(sink);
    }
    /// "08:21:17.982" in seconds.
    static std::optional<double> seconds_of(std::string_view text) {
        double seconds = 0;
        for (int part = 0; part < 3; ++part) {
            const scanned_number number = scan_number(text.data(), text.data() + text.size());
            if (number.end == nullptr)
                return std::nullopt;
            seconds = seconds * 60 + number.value;
            text.remove_prefix(static_cast<std::size_t>(number.end - text.data()));
            if (part < 2 && !text.starts_with(':'))
                return std::nullopt;
            text.remove_prefix(part < 2 ? 1 : 0);
        }
        return std::isfinite(seconds) ? std::optional(seconds) : std::nullopt;
    }

    double unit_ = 1;
    std::size_t header_bytes_ = 0;
    std::optional<std::uint64_t> number_; ///< of the present frame
    std::optional<double> seconds_, first_seconds_;
    std::vector<float> gathered_; ///< the cells of the present frame, sensor by sensor
    std::size_t sensors_ = 0, first_rows_ = 0, first_columns_ = 0;
    std::size_t rows_ = 0, columns_ = 0, rows_read_ = 0; ///< of the present sensor
    bool in_sensor_ = false, in_sensels_ = false;
};

}} // namespace tactnet
