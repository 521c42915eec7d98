#pragma once

#include <tactnet/sensors/described/checksum.hpp>
#include <tactnet/sensors/described/description.hpp>
#include <tactnet/sensors/described/text_stream.hpp>
#include <tactnet/sensors/text/lines.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

// Proposes a description of bytes whose layout is unknown: a start, to be checked by a person. What cannot be
// known from bytes, such as rows and columns of a line of 256 numbers, is guessed as the most compact shape.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The two factors that are nearest to each other, the larger one first.
[[nodiscard]] constexpr std::pair<std::size_t, std::size_t> nearest_factors(std::size_t cells) noexcept {
    std::size_t columns = 1;
    for (std::size_t i = 1; i * i <= cells; ++i)
        if (cells % i == 0)
            columns = i;
    return {cells / columns, columns};
}

/// A line of numbers, after fields that are none.
struct counted_line {
    std::size_t leading = 0, numbers = 0;
    double first = 0;
};
[[nodiscard]] inline counted_line count_fields(std::string_view line, bool decimal_comma) {
    counted_line result;
    field_scanner fields(line, decimal_comma);
    for (double value = 0; !fields.at_end();)
        if (fields.number(value)) {
            result.first = result.numbers == 0 ? value : result.first;
            ++result.numbers;
        } else {
            fields.skip();
            result.leading += result.numbers + 1;
            result.numbers = 0;
        }
    return result;
}

[[nodiscard]] inline std::optional<sensor_description> guess_text(std::string_view text) {
    sensor_description d{.cell = cell_type::digits};
    const std::string padded = std::string(text.substr(0, std::min(text.rfind('\n'), text.size()))) + '\n';
    std::vector<std::string_view> lines;
    for (std::size_t at = 0; at < padded.size() && lines.size() < largest_header_lines;) {
        const std::size_t end = padded.find('\n', at);
        std::string_view line = std::string_view(padded).substr(at, end - at);
        if (line.ends_with('\r'))
            line.remove_suffix(1);
        lines.push_back(line);
        at = end + 1;
    }
    // A comma between digits beside another separator is a decimal one.
    std::size_t commas = 0, others = 0;
    for (const std::string_view line : lines)
        for (const char c : line)
            commas += c == ',', others += c == ';' || c == '\t';
    d.decimal_comma = commas > 0 && others > 0;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> kinds;
    for (const std::string_view line : lines)
        if (const counted_line counted = count_fields(line, d.decimal_comma); counted.numbers > 0)
            ++kinds[{counted.leading, counted.numbers}];
    if (kinds.empty())
        return std::nullopt;
    const auto usual = std::max_element(kinds.begin(), kinds.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
    d.leading_fields = usual->first.first;
    std::size_t numbers = usual->first.second;
    // Lines of that kind, between blank ones; the first number of each; negative numbers.
    std::vector<std::size_t> blocks{0};
    std::vector<double> firsts;
    bool begun = false;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const counted_line counted = count_fields(lines[i], d.decimal_comma);
        if (std::pair(counted.leading, counted.numbers) == usual->first) {
            d.header_lines = begun ? d.header_lines : i;
            begun = true;
            ++blocks.back();
            firsts.push_back(counted.first);
        } else if (blocks.back() > 0) {
            blocks.push_back(0);
        }
    }
    if (blocks.back() == 0)
        blocks.pop_back();
    // A number that rises from line to line by more than a count is a time.
    bool rises = d.leading_fields == 0 && firsts.size() > 3 && numbers > 2 &&
                 (numbers - 1 == 1 || nearest_factors(numbers).second < 2 ||
                  nearest_factors(numbers - 1).second > nearest_factors(numbers).second);
    for (std::size_t i = 1; i < firsts.size(); ++i)
        rises = rises && firsts[i] > firsts[i - 1];
    if (rises) {
        d.leading_fields = 1;
        d.seconds_per_tick = 0.001;
        --numbers;
    }
    const bool rows =
        blocks.size() > 1 && blocks[0] > 1 && !rises &&
        std::all_of(blocks.begin(), blocks.end() - 1, [&](std::size_t n) { return n == blocks[0]; });
    if (rows) {
        d.line = line_content::row;
        d.rows = blocks[0], d.columns = numbers;
    } else {
        std::tie(d.rows, d.columns) = nearest_factors(numbers);
    }
    return problem_of(d) ? std::nullopt : std::optional(d);
}

/// Whether packets of `d` begin at each of `starts`.
[[nodiscard]] inline bool checksum_fits(const sensor_description& d, std::span<const std::byte> bytes,
                                        const std::vector<std::size_t>& starts) {
    const checksum_of check(d.checksum);
    const std::size_t covered = d.packet_bytes() - d.checksum.bytes();
    const std::size_t from = d.checksum.with_marker ? 0 : d.marker.size();
    return std::all_of(starts.begin(), starts.end(), [&](std::size_t start) {
        return check.follows(bytes.subspan(start + from, covered - from), bytes.subspan(start + covered));
    });
}

[[nodiscard]] inline std::optional<sensor_description> guess_packets(std::span<const std::byte> bytes) {
    bytes = bytes.first(std::min(bytes.size(), std::size_t{1} << 18));
    // The pair of bytes that comes back most often at one distance.
    std::map<std::pair<std::uint16_t, std::size_t>, std::size_t> gaps;
    std::vector<std::size_t> latest(65536, bytes.size());
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
        const auto pair = big_endian<std::uint16_t>(bytes.subspan(i));
        if (latest[pair] < i && i - latest[pair] > 4)
            ++gaps[{pair, i - latest[pair]}];
        latest[pair] = i;
    }
    std::size_t size = 0, best = 0;
    std::uint16_t pair = 0;
    for (const auto& [gap, count] : gaps)
        if (count >= 3 && count * gap.second > best)
            best = count * gap.second, size = gap.second, pair = gap.first;
    if (size == 0 || best < bytes.size() / 2 || bytes.size() < 4 * size)
        return std::nullopt;
    // Bytes that are the same in nearly every packet, from that pair on.
    std::size_t start = 0;
    while (start + 2 <= bytes.size() && big_endian<std::uint16_t>(bytes.subspan(start)) != pair)
        ++start;
    std::vector<std::size_t> starts;
    for (std::size_t at = start; at + size <= bytes.size(); at += size)
        if (big_endian<std::uint16_t>(bytes.subspan(at)) == pair)
            starts.push_back(at);
    if (starts.size() < 3)
        return std::nullopt;
    sensor_description d{.marker = {bytes[start], bytes[start + 1]}};
    const std::size_t body = size - 2;
    for (const auto kind : {checksum_kind::none, checksum_kind::crc16, checksum_kind::sum16,
                            checksum_kind::crc8, checksum_kind::xor8, checksum_kind::sum8})
        for (const bool with_marker : {true, false})
            for (const std::uint16_t initial : std::array<std::uint16_t, 2>{0, 0xFFFF}) {
                sensor_description tried = d;
                tried.checksum = {.kind = kind, .with_marker = with_marker, .initial = initial};
                const std::size_t cells = body - tried.checksum.bytes();
                tried.rows = cells, tried.columns = 1;
                if (d.checksum.kind == checksum_kind::none && kind != checksum_kind::none &&
                    body > tried.checksum.bytes() && checksum_fits(tried, bytes, starts))
                    d.checksum = tried.checksum;
            }
    std::size_t cells = body - d.checksum.bytes();
    if (nearest_factors(cells).second < 2 && cells > 1) // a number of the packet, for example
        d.header_bytes = 1, --cells;
    // High bytes of words are small, if counts are.
    std::array<double, 2> sums{};
    for (const std::size_t at : starts)
        for (std::size_t i = 0; i < cells; ++i)
            sums[i % 2] += static_cast<double>(bytes[at + 2 + d.header_bytes + i]);
    if (cells % 2 == 0 && (sums[1] < sums[0] / 4 || sums[0] < sums[1] / 4)) {
        d.cell = cell_type::uint16;
        d.cell_bytes = sums[1] < sums[0] ? byte_order::little : byte_order::big;
        cells /= 2;
    }
    std::tie(d.rows, d.columns) = nearest_factors(cells);
    return problem_of(d) ? std::nullopt : std::optional(d);
}

} // namespace detail

/// A description that the bytes of a recording or of a device may have; nothing if none is seen. Give it some
/// seconds of a stream. Rows, columns and the order of the cells are a guess.
[[nodiscard]] inline std::optional<sensor_description> guess_sensor(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                                std::min(bytes.size(), std::size_t{1} << 22));
    const bool printable = std::all_of(text.begin(), text.end(), [](char c) {
        return c == '\n' || c == '\r' || c == '\t' || static_cast<unsigned char>(c) >= 0x20;
    });
    return printable && !text.empty() ? detail::guess_text(text) : detail::guess_packets(bytes);
}

}} // namespace tactnet
