// How fast recordings are decoded on one core, compared with a reader on std::istream in the same run, in
// turns. The recordings are made here: frames of 28 × 28 cells with the margins and the hand that real ones
// have, as text, and of 44 × 52 cells as a binary recording, once with a few touched cells and once with all.
// Every round checks the sum of all cells. With a file as argument, that is decoded as well. Run it pinned to
// an idle core.

#include "../support/measure.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/described/matrix_stream.hpp>
#include <tactnet/sensors/described/text_stream.hpp>
#include <tactnet/sensors/recording.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

namespace {

constexpr std::size_t rounds = 9;

/// A recording and what must come out of it.
struct sample {
    std::string bytes;
    double cells = 0, sum = 0;
};

/// Counts that look like a finger here and noise there.
std::uint32_t count_at(std::size_t frame, std::size_t row, std::size_t column) {
    const std::uint32_t hash =
        static_cast<std::uint32_t>(frame * 31 + row * 7919 + column * 104729) * 2654435761U;
    const bool touched = row > 17 && row < 22 && column > 16 && column < 24;
    return touched ? (hash >> 24U) : hash % 97 == 0 ? 5 : 0;
}

sample make_text(std::size_t frames) {
    sample s;
    s.bytes = "ROWS 28\r\nCOLS 28\r\nSECONDS_PER_FRAME 0.1\r\nUNITS raw\r\nASCII_DATA @@\r\n";
    for (std::size_t f = 1; f <= frames; ++f) {
        std::string rows;
        std::uint64_t sum = 0;
        for (std::size_t r = 0; r < 28; ++r)
            for (std::size_t c = 0; c < 28; ++c) {
                const bool margin = r < 2 || r > 25 || c < 2 || c > 25 || c == 13 || c == 14;
                sum += margin ? 0 : count_at(f, r, c);
                rows += margin ? "B" : std::to_string(count_at(f, r, c));
                rows += c < 27 ? "," : "\r\n";
            }
        s.bytes += "\r\nFrame " + std::to_string(f) + ", 0.1,, 12/2/2019 6:21:52.34PM,,,Raw Sum=,," +
                   std::to_string(sum) + "\r\n" + rows;
        s.sum += static_cast<double>(sum);
        s.cells += 28 * 28;
    }
    s.bytes += "@@\r\n";
    return s;
}

sample make_binary(std::size_t frames, bool dense) {
    sample s;
    s.bytes = "ROWS 44\nCOLS 52\n\xBB\xBA";
    const auto number = [&](std::size_t value) {
        s.bytes += static_cast<char>(value & 0xFFU);
        s.bytes += static_cast<char>(value >> 8U);
    };
    for (std::size_t f = 1; f <= frames; ++f) {
        for (std::size_t r = 0; r < 44; ++r) {
            const std::size_t from = dense ? 0 : 20, cells = dense ? 52 : r > 15 && r < 26 ? 6 : 0;
            if (cells == 0)
                continue;
            number(r * 52 + from);
            s.bytes += static_cast<char>(cells);
            for (std::size_t c = 0; c < cells; ++c) {
                const std::size_t value = (f + r * 3 + c * 7) % 256;
                s.bytes += static_cast<char>(value);
                s.sum += static_cast<double>(value);
            }
        }
        number(0xFFFF);
        number(2), number(8);
        for (int byte = 0; byte < 4; ++byte)
            number(0);
        number(0xFFFF);
        s.cells += 44 * 52;
    }
    s.bytes += "\xFF\xFE";
    return s;
}

/// Packets of 28 × 50 cells, and lines of as many numbers.
tactnet::sensor_description packet_description(tactnet::cell_type cell, tactnet::checksum_kind checksum) {
    return {.rows = 28,
            .columns = 50,
            .cell = cell,
            .marker = {std::byte{0xAA}, std::byte{0x55}},
            .checksum = {.kind = checksum}};
}
sample make_packets(const tactnet::sensor_description& description, std::size_t frames) {
    sample s;
    for (std::size_t f = 1; f <= frames; ++f) {
        std::string packet = "\xAA\x55";
        for (std::size_t cell = 0; cell < description.cells(); ++cell) {
            const std::uint32_t value = std::min(count_at(f, cell / 50, cell % 50), 100U);
            packet += static_cast<char>(value);
            packet.append(description.cell_size() - 1, '\0');
            s.sum += static_cast<double>(value);
        }
        const auto sum = tactnet::checksum_of(description.checksum)(std::as_bytes(std::span(packet)));
        if (description.checksum.bytes() == 2)
            (packet += static_cast<char>(sum & 255U)) += static_cast<char>(sum >> 8U);
        s.bytes += packet;
        s.cells += static_cast<double>(description.cells());
    }
    return s;
}
sample make_lines(std::size_t frames, unsigned scale) {
    sample s;
    for (std::size_t f = 1; f <= frames; ++f) {
        for (std::size_t cell = 0; cell < 28 * 50; ++cell) {
            const std::uint32_t hash = static_cast<std::uint32_t>(f * 1400 + cell) * 2654435761U;
            const std::uint32_t value =
                scale == 0 ? hash >> (22 + hash % 10) : scale * count_at(f, cell / 50, cell % 50) + scale - 1;
            s.bytes += std::to_string(value) + (cell + 1 < 28 * 50 ? "," : "\n");
            s.sum += static_cast<double>(value);
        }
        s.cells += 28 * 50;
    }
    return s;
}

/// Of whole numbers, so exact in any order: side by side, or the check would cost more than what it checks.
double sum_of(std::span<const float> cells) {
    std::array<float, 32> sums{};
    std::size_t i = 0;
    for (; i + sums.size() <= cells.size(); i += sums.size())
        for (std::size_t lane = 0; lane < sums.size(); ++lane)
            sums[lane] += cells[i + lane];
    double sum = 0;
    for (const float part : sums)
        sum += static_cast<double>(part);
    for (; i < cells.size(); ++i)
        sum += static_cast<double>(cells[i]);
    return sum;
}

template <class Decoder, class... Arguments>
double sum_with(std::string_view bytes, const Arguments&... arguments) {
    Decoder decoder(arguments...);
    double sum = 0;
    const auto add = [&](const tactnet::frame_view& frame) { sum += sum_of(frame.cells); };
    decoder.push(std::as_bytes(std::span(bytes)), add);
    return decoder.finish(add) == tactnet::decode_status::finished ? sum : -1;
}

/// What one writes without thinking of speed: lines by getline, cells by >>.
double sum_with_stream(std::string_view bytes) {
    std::istringstream text{std::string(bytes)};
    double sum = 0;
    std::string line, cell;
    while (std::getline(text, line) && !line.starts_with("ASCII_DATA")) {
    }
    while (std::getline(text, line) && !line.starts_with("@@")) {
        if (line.starts_with("Frame") || line.size() < 2)
            continue;
        std::istringstream row(line);
        for (float value = 0; !row.eof();) {
            if (row >> std::ws; row.peek() == 'B')
                row.get();
            else if (row >> value)
                sum += static_cast<double>(value);
            row.clear(row.rdstate() & std::ios::eofbit);
            row >> std::ws;
            if (row.peek() != ',')
                break;
            row.get();
        }
    }
    return sum;
}

bool all_right = true;

template <class Body>
double fastest(const sample& s, Body&& body) {
    const auto time =
        benchmark::time_rounds(rounds, [&] { all_right = all_right && body(s.bytes) == s.sum; });
    return time.fastest;
}

void print(const char* name, const sample& s, double seconds) {
    std::printf("%-34s %10.1f MB %9.0f MB/s %9.2f G cells/s\n", name,
                static_cast<double>(s.bytes.size()) / 1e6,
                static_cast<double>(s.bytes.size()) / seconds / 1e6, s.cells / seconds / 1e9);
}

} // namespace

int main(int count, char** arguments) {
    const sample text = make_text(8000), sparse = make_binary(20'000, false), dense = make_binary(4000, true);
    const double ours =
        fastest(text, [](std::string_view bytes) { return sum_with<tactnet::tekscan_ascii>(bytes); });
    const sample less = make_text(800);
    const double stream = fastest(less, sum_with_stream);
    print("text recording", text, ours);
    print("the same with std::istream", less, stream);
    std::printf("%-34s %10.1f times\n", "faster",
                stream / static_cast<double>(less.bytes.size()) /
                    (ours / static_cast<double>(text.bytes.size())));
    print("binary recording, few touched cells", sparse,
          fastest(sparse, [](std::string_view bytes) { return sum_with<tactnet::tekscan_binary>(bytes); }));
    print("binary recording, all cells", dense,
          fastest(dense, [](std::string_view bytes) { return sum_with<tactnet::tekscan_binary>(bytes); }));
    using enum tactnet::cell_type;
    using enum tactnet::checksum_kind;
    for (const auto& [name, description] :
         {std::pair("packets of bytes", packet_description(uint8, none)),
          std::pair("packets of 16 bits", packet_description(uint16, none)),
          std::pair("packets of 32 bits", packet_description(uint32, none)),
          std::pair("packets of bytes, CRC-16", packet_description(uint8, crc16))}) {
        const sample packets = make_packets(description, 20'000);
        print(name, packets, fastest(packets, [&](std::string_view bytes) {
                  return sum_with<tactnet::matrix_stream>(bytes, description);
              }));
    }
    const tactnet::sensor_description numbers{.rows = 28, .columns = 50, .cell = tactnet::cell_type::digits};
    for (const auto& [name, scale] :
         {std::pair("lines of few digits", 1U), std::pair("lines of four digits", 1000U),
          std::pair("lines of one to four digits", 0U)}) {
        const sample lines = make_lines(8000, scale);
        print(name, lines, fastest(lines, [&](std::string_view bytes) {
                  return sum_with<tactnet::text_stream>(bytes, numbers);
              }));
    }
    for (int i = 1; i < count; ++i) {
        const auto bytes = tactnet::read_file(arguments[i]);
        sample file{{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, 0, 0};
        const auto whole = tactnet::decode_all(tactnet::any_recording(), bytes);
        file.cells = static_cast<double>(whole.size() * whole.description.cells());
        file.sum = sum_with<tactnet::any_recording>(file.bytes);
        print(arguments[i], file,
              fastest(file, [](std::string_view all) { return sum_with<tactnet::any_recording>(all); }));
    }
    if (!all_right)
        std::printf("WRONG sums\n");
    return all_right ? EXIT_SUCCESS : EXIT_FAILURE;
}
