#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/calibration.hpp>
#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/sensors/tekscan/header.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/text/measures.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Tekscan's equilibration (.equ): a text header, the bytes BB BA B8 01 00 00, a block of unknown meaning, and
// three tables of 16 bits per cell: the counts under even pressure times 10 and rounded, the same times 500,
// and the mean of all, to which equilibration brings each cell. As seen in files of I-Scan 7.5.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The counts of each cell under even pressure.
struct tekscan_equilibration {
    recording_description description;
    std::vector<float> counts; ///< row by row
    /// One gain per cell: see equilibration_gains. Throws std::invalid_argument if a tactel is zero.
    [[nodiscard]] std::vector<float> gains() const { return equilibration_gains(counts, description); }
};

/// Reads the bytes of an equilibration; `file` names it in errors. Throws file_error if they are something
/// else.
[[nodiscard]] inline tekscan_equilibration parse_equilibration(std::span<const std::byte> bytes,
                                                               const std::string& file = {}) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    constexpr std::string_view start{"\n\xBB\xBA\xB8\x01\0\0", 7};
    constexpr std::size_t before_tables = 1478, after_tables = 4096 + 2;
    const std::size_t end = text.substr(0, largest_header_bytes).find(start);
    if (end == std::string_view::npos)
        throw file_error(file, "", "an equilibration of Tekscan (bytes BB BA B8 01 00 00 after a header)",
                         "none");
    tekscan_equilibration result;
    result.description.format = "Tekscan equilibration";
    std::size_t rows = 0, columns = 0;
    for (std::size_t at = 0; at <= end;) {
        const std::size_t stop = std::min(text.find('\n', at), end);
        const std::string_view line = text.substr(at, stop - at);
        const std::size_t blank = std::min(line.find(' '), line.size());
        const std::string_view key = line.substr(0, blank), value = trimmed(line.substr(blank));
        result.description.header.emplace_back(key, value);
        if (key == "ROWS" || key == "COLS")
            (key == "ROWS" ? rows : columns) = static_cast<std::size_t>(whole_number(value).value_or(0));
        at = stop + 1;
    }
    if (rows == 0 || columns == 0 || rows > largest_frame_cells / columns)
        throw file_error(file, "header",
                         detail::joined({"ROWS and COLS of 1 to ", largest_frame_cells, " cells"}),
                         detail::joined({rows, " x ", columns}));
    const std::size_t cells = rows * columns;
    const std::span<const std::byte> body = bytes.subspan(end + 1);
    if (body.size() != before_tables + 6 * cells + after_tables)
        throw file_error(file, detail::joined({"byte ", end + 1}),
                         detail::joined({before_tables + 6 * cells + after_tables, " bytes"}),
                         detail::joined({body.size()}));
    result.description.rows = rows, result.description.columns = columns;
    const auto at = [&](std::size_t table, std::size_t cell) {
        return little_endian<std::uint16_t>(body.subspan(before_tables + 2 * (table * cells + cell)));
    };
    for (std::size_t cell = 0; cell < cells; ++cell) {
        const int rounded = at(0, cell) * 50, exact = at(1, cell);
        if (std::abs(rounded - exact) > 50)
            throw file_error(file, detail::joined({"cell ", cell}), "a count near " + std::to_string(rounded),
                             std::to_string(exact));
        result.counts.push_back(static_cast<float>(exact) / 500);
    }
    return result;
}

/// Reads a file of equilibration. Throws file_error if it cannot be read or is something else.
[[nodiscard]] inline tekscan_equilibration read_equilibration(const std::filesystem::path& path) {
    return parse_equilibration(read_file(path), path.string());
}

}} // namespace tactnet
