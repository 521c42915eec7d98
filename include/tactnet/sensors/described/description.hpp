#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/text/numbers.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// The description of an array: all that a decoder must know of a device or a table that does not describe
// itself. A value in C++ and, with description_file.hpp, a small JSON file.
//
// Frames have counts of zero or more: zero where nothing touches the array, NaN for a broken cell. Networks
// reject a frame with NaN, so that a broken cell is never classified by mistake: sensor_health reports broken
// cells as faulty and fills them.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The encoding of a cell. Digits are numbers in a text, with or without a fraction.
enum class cell_type : std::uint8_t {
    uint8,
    int8,
    uint16,
    int16,
    uint32,
    int32,
    uint64,
    int64,
    float32,
    float64,
    digits
};
/// The byte that comes first.
enum class byte_order : std::uint8_t { little, big };
/// The order in which a device scans its cells: row by row or column by column.
enum class cell_order : std::uint8_t { rows, columns };
/// Whether a device sends all of its array in one piece, or one half before the other.
enum class block_order : std::uint8_t { one, side_by_side, stacked };
/// What a line of a text has.
enum class line_content : std::uint8_t { frame, row };
/// The algorithm of a checksum.
enum class checksum_kind : std::uint8_t { none, sum8, sum16, xor8, crc8, crc16 };

/// The checksum of a packet, which covers all bytes before it.
struct packet_checksum {
    checksum_kind kind = checksum_kind::none;
    bool with_marker = true; ///< whether the marker is covered too
    bool negated = false;    ///< of sums: the packet with its checksum sums to zero
    byte_order order = byte_order::little;
    std::uint16_t polynomial = 0; ///< of a CRC, without its highest bit; 0: 07 or 1021 (hexadecimal)
    std::uint16_t initial = 0;    ///< the value before the first byte
    std::uint16_t final_xor = 0;  ///< exclusive or with the result
    bool reflected = false;       ///< of a CRC: the lowest bit comes first

    [[nodiscard]] std::size_t bytes() const noexcept {
        return kind == checksum_kind::none                                    ? 0
               : kind == checksum_kind::sum16 || kind == checksum_kind::crc16 ? 2
                                                                              : 1;
    }
    friend bool operator==(const packet_checksum&, const packet_checksum&) = default;
};

/// The description of an array. Only rows and columns have no default.
///
/// A packet is marker, header, cells, trailer, checksum, end. A line of text has leading fields, such as a
/// label or a time stamp, then the cells of a frame or of a row.
struct sensor_description {
    /// As the device scans them, before `transposed` and `rotation`.
    std::size_t rows = 0, columns = 0;

    cell_type cell = cell_type::uint8;
    byte_order cell_bytes = byte_order::little;

    cell_order order = cell_order::rows;
    bool serpentine = false;               ///< every second row (or column) is scanned backwards
    block_order blocks = block_order::one; ///< two halves of the array, each in this order
    // What is then done to the frame, in this order:
    bool transposed = false;
    bool flipped_rows = false, flipped_columns = false; ///< upside down; left to right
    unsigned rotation = 0;                              ///< degrees clockwise: 0, 90, 180, 270

    std::vector<std::byte> marker{}; ///< before every frame
    std::size_t header_bytes = 0;    ///< between marker and cells, skipped
    std::size_t trailer_bytes = 0;   ///< between cells and checksum, skipped
    packet_checksum checksum{};
    std::size_t end_bytes = 0; ///< after the checksum, skipped

    line_content line = line_content::frame;
    std::size_t header_lines = 0;              ///< skipped at the start of a text
    std::size_t leading_fields = 0;            ///< in each line before the cells
    bool decimal_comma = false;                ///< then fields are not separated by commas
    std::optional<double> seconds_per_tick{};  ///< if the first leading field is a time stamp
    std::optional<double> seconds_per_frame{}; ///< if there are no time stamps

    /// The value of an untouched cell. A count is value - offset, or offset - value if `inverted`; less than
    /// zero is zero.
    double offset = 0;
    bool inverted = false;
    /// Without an offset, a negative value is damage, unless this is set.
    bool negative_is_zero = false;
    std::optional<double> full_scale{};          ///< the largest count; larger ones are kept
    std::optional<double> full_scale_pressure{}; ///< pascal at full_scale
    bool in_pascal = false;                      ///< counts are pascals
    /// Values, before the offset, that mark a broken cell, at most 256; infinity and NaN are possible.
    std::vector<double> broken{std::numeric_limits<double>::quiet_NaN()};
    std::optional<double> broken_above{};                  ///< larger values mark a broken cell, too
    std::optional<double> row_spacing{}, column_spacing{}; ///< of the frame: metres

    [[nodiscard]] std::size_t cells() const noexcept { return rows * columns; }
    /// Whether frames have as many rows as the device has columns.
    [[nodiscard]] bool swaps_axes() const noexcept { return transposed != (rotation % 180 != 0); }
    /// The size of the frames.
    [[nodiscard]] std::size_t frame_rows() const noexcept { return swaps_axes() ? columns : rows; }
    [[nodiscard]] std::size_t frame_columns() const noexcept { return swaps_axes() ? rows : columns; }
    /// Bytes of a cell; 0 of digits.
    [[nodiscard]] std::size_t cell_size() const noexcept {
        constexpr std::array<std::size_t, 11> sizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 0};
        return sizes[static_cast<std::size_t>(cell)];
    }
    [[nodiscard]] std::size_t packet_bytes() const noexcept {
        return marker.size() + header_bytes + cells() * cell_size() + trailer_bytes + checksum.bytes() +
               end_bytes;
    }
};

/// What is wrong with a field of a description.
struct description_problem {
    std::string field, expected, found;
    /// "sensor description: 'rows': expected …, found …".
    [[nodiscard]] std::string message() const {
        return error_sentence("sensor description", detail::joined({detail::quoted{field}}), expected, found);
    }
};

/// The largest number of bytes of a packet that are not cells, of each kind.
inline constexpr std::size_t largest_packet_part = std::size_t{1} << 22;

/// The first field of a description that cannot be; nothing if all are right.
[[nodiscard]] inline std::optional<description_problem> problem_of(const sensor_description& d) {
    const auto problem = [](const char* field, detail::text_parts expected, detail::text_parts found) {
        return description_problem{field, detail::joined(expected), detail::joined(found)};
    };
    if (d.rows == 0 || d.rows > largest_frame_cells)
        return problem("rows", {"1 to ", largest_frame_cells}, {d.rows});
    if (d.columns == 0 || d.columns > largest_frame_cells / d.rows)
        return problem("columns", {"1 to ", largest_frame_cells, " cells"}, {d.rows, " x ", d.columns});
    if (d.blocks == block_order::side_by_side && d.columns % 2 != 0)
        return problem("blocks", {"an even number of columns"}, {d.columns});
    if (d.blocks == block_order::stacked && d.rows % 2 != 0)
        return problem("blocks", {"an even number of rows"}, {d.rows});
    if (d.rotation % 90 != 0 || d.rotation > 270)
        return problem("rotation", {"0, 90, 180 or 270"}, {d.rotation});
    if (d.marker.size() > largest_packet_part)
        return problem("marker", {"at most ", largest_packet_part, " bytes"}, {d.marker.size()});
    for (const auto& [name, bytes] :
         {std::pair("header_bytes", d.header_bytes), std::pair("trailer_bytes", d.trailer_bytes),
          std::pair("end_bytes", d.end_bytes)})
        if (bytes > largest_packet_part)
            return problem(name, {"at most ", largest_packet_part}, {bytes});
    const bool binary = d.cell != cell_type::digits;
    const bool framed = !d.marker.empty() || d.header_bytes + d.trailer_bytes + d.end_bytes > 0 ||
                        d.checksum.kind != checksum_kind::none;
    if (!binary && framed)
        return problem("cell", {"bytes, since there is a marker, a header, a trailer or a checksum"},
                       {"digits"});
    if (d.seconds_per_tick && d.leading_fields == 0)
        return problem("leading_fields", {"1 or more, since there is a time stamp"}, {"0"});
    if (binary && d.decimal_comma)
        return problem("decimal_comma", {"false, since cells are not digits"}, {"true"});
    if (d.header_lines > largest_header_lines)
        return problem("header_lines", {"at most ", largest_header_lines}, {d.header_lines});
    if (d.leading_fields > largest_header_lines)
        return problem("leading_fields", {"at most ", largest_header_lines}, {d.leading_fields});
    if (!std::isfinite(d.offset))
        return problem("offset", {"a finite number"}, {std::to_string(d.offset)});
    for (const auto& [name, value] :
         {std::pair("full_scale", d.full_scale), std::pair("full_scale_pressure", d.full_scale_pressure),
          std::pair("seconds_per_tick", d.seconds_per_tick),
          std::pair("seconds_per_frame", d.seconds_per_frame), std::pair("row_spacing", d.row_spacing),
          std::pair("column_spacing", d.column_spacing)})
        if (value && !(*value >= 1e-30 && *value <= 1e30)) // what is computed of them stays finite
            return problem(name, {"1e-30 to 1e30"}, {shortest_number(*value)});
    if (d.broken.size() > 256)
        return problem("broken", {"at most 256 values"}, {d.broken.size()});
    if (d.full_scale_pressure && !d.full_scale)
        return problem("full_scale", {"a number, since there is a full_scale_pressure"}, {"none"});
    return std::nullopt;
}

/// Throws std::invalid_argument with the first problem of a description.
inline void require_valid(const sensor_description& description) {
    if (const auto problem = problem_of(description))
        detail::throw_invalid_argument({problem->message()});
}

/// What a decoder says about a source of this description.
[[nodiscard]] inline recording_description describe(const sensor_description& d, std::string format) {
    require_valid(d);
    return {.format = std::move(format),
            .rows = d.frame_rows(),
            .columns = d.frame_columns(),
            .row_spacing = d.row_spacing,
            .column_spacing = d.column_spacing,
            .unit = d.in_pascal ? pressure_unit::pascal : pressure_unit::raw,
            .full_scale = d.full_scale,
            .saturation_pressure = d.full_scale_pressure,
            .seconds_per_frame = d.seconds_per_frame};
}

}} // namespace tactnet
