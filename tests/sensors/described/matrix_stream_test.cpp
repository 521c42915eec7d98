#include "../decoded.hpp"

#include <tactnet/sensors/described/checksum.hpp>
#include <tactnet/sensors/described/matrix_stream.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>
#include <string>
#include <string_view>
#include <support/allocations.hpp>
#include <tuple>
#include <utility>
#include <vector>

using sensors_test::bytes_of;
using tactnet::decode_status;
using tactnet::matrix_stream;
using tactnet::sensor_description;
using enum tactnet::frame_delivery;
using namespace std::string_literals;

namespace {

const sensor_description bare{.rows = 2, .columns = 3};

sensor_description marked() {
    sensor_description format{.rows = 2, .columns = 3};
    format.marker = {std::byte{'M'}, std::byte{'M'}, std::byte{'X'}};
    format.header_bytes = 1;
    format.trailer_bytes = 2;
    format.seconds_per_frame = 0.5;
    return format;
}

std::vector<float> cells_of(const sensor_description& format, const std::string& bytes) {
    const auto found = sensors_test::decode(matrix_stream(format), bytes_of(bytes));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 1);
    return found.frames[0].cells;
}

} // namespace

static_assert(tactnet::frame_decoder<matrix_stream>);

TEST_CASE("matrix_stream: every form and every order of the cells, against frames written by hand") {
    using enum tactnet::cell_type;
    using enum tactnet::cell_order;
    using tactnet::block_order, tactnet::byte_order;
    const std::string six("\0\1\2\3\4\5", 6), eight = six + "\6\7";
    for (const auto& [format, bytes, cells] :
         std::vector<std::tuple<sensor_description, std::string, std::vector<float>>>{
             {bare, "\1\2\3\4\5\6", {1, 2, 3, 4, 5, 6}},
             {{.rows = 2, .columns = 3, .order = columns}, "\1\4\2\5\3\6", {1, 2, 3, 4, 5, 6}},
             {{.rows = 1, .columns = 2, .cell = uint16}, "\1\2\xFF\xFF", {513, 65535}},
             {{.rows = 1, .columns = 2, .cell = uint16, .cell_bytes = byte_order::big},
              "\1\2\xFF\xFE",
              {258, 65534}},
             {{.rows = 1, .columns = 1, .cell = int32, .cell_bytes = byte_order::big}, "\0\1\0\1"s, {65537}},
             {{.rows = 1, .columns = 1, .cell = uint64, .cell_bytes = byte_order::big},
              "\0\0\0\0\1\2\3\4"s,
              {16909060}},
             {{.rows = 1, .columns = 1, .cell = float64, .cell_bytes = byte_order::big},
              "\x3F\xF8\0\0\0\0\0\0"s,
              {1.5F}},
             {{.rows = 1, .columns = 2, .cell = float32}, "\0\0\xC0\x3F\0\0\0\0"s, {1.5F, 0}},
             {{.rows = 2, .columns = 3, .serpentine = true}, six, {0, 1, 2, 5, 4, 3}},
             {{.rows = 2, .columns = 3, .order = columns, .serpentine = true}, six, {0, 3, 4, 1, 2, 5}},
             {{.rows = 2, .columns = 4, .blocks = block_order::side_by_side},
              eight,
              {0, 1, 4, 5, 2, 3, 6, 7}},
             {{.rows = 4, .columns = 1, .blocks = block_order::stacked, .flipped_rows = true},
              six.substr(0, 4),
              {3, 2, 1, 0}},
             {{.rows = 2, .columns = 3, .transposed = true}, six, {0, 3, 1, 4, 2, 5}},
             {{.rows = 2, .columns = 3, .flipped_columns = true}, six, {2, 1, 0, 5, 4, 3}},
             {{.rows = 2, .columns = 3, .rotation = 90}, six, {3, 0, 4, 1, 5, 2}},
             {{.rows = 2, .columns = 3, .rotation = 180}, six, {5, 4, 3, 2, 1, 0}},
             {{.rows = 2, .columns = 3, .transposed = true, .rotation = 270}, six, {3, 4, 5, 0, 1, 2}}})
        CHECK(cells_of(format, bytes) == cells);
}

TEST_CASE("matrix_stream: markers: joined anywhere, lost and found again") {
    const std::string one = "MMX_\1\2\3\4\5\6__", two = "MMX_\6\5\4\3\2\1__";
    const auto whole = sensors_test::decode(matrix_stream(marked()), bytes_of(one + two));
    REQUIRE(whole.frames.size() == 2);
    CHECK(whole.frames[1].cells == std::vector<float>{6, 5, 4, 3, 2, 1});
    CHECK(whole.frames[1].seconds == 0.5);
    CHECK(whole.status == decode_status::finished);
    // A marker that begins inside what looked like one.
    matrix_stream joined(marked(), immediate);
    CHECK(joined.push(bytes_of("xMXM" + one.substr(1)), tactnet::ignore_frames{}) == decode_status::reading);
    CHECK(joined.push(bytes_of("M" + one), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(joined.frames() == 2);
    CHECK(joined.skipped_bytes() == 4);
    CHECK(joined.error().expected == "the marker of a frame");
    CHECK(joined.push(bytes_of(one), tactnet::ignore_frames{}) == decode_status::reading);
    // One report for all bytes between two frames, with the place of the first.
    CHECK(joined.push(bytes_of("zzz" + one), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(joined.error().place() == "byte 40, frame 4");
    CHECK(joined.skipped_bytes() == 7);
    CHECK(sensors_test::same_however_split(matrix_stream(marked()), bytes_of("xMX" + one + two)));
    CHECK(sensors_test::decode(matrix_stream(marked()), bytes_of(one + "MMX_\1")).error ==
          "byte 12, frame 2: expected a whole frame of 12 bytes, found 5 bytes of it");
}

TEST_CASE("matrix_stream: markers: each bit flipped, each byte lost or doubled") {
    // Numbers of cells are numbers of frames, so that each frame shows which one it is.
    constexpr std::size_t frames = 6, size = 12, marker = 3;
    std::string stream;
    for (std::size_t f = 0; f < frames; ++f)
        stream += "MMX_" + std::string(6, static_cast<char>(f + 1)) + "__";
    const auto whole_frames = [](const sensors_test::decoded& found) {
        std::vector<std::size_t> numbers;
        for (const auto& frame : found.frames)
            if (frame.cells == std::vector<float>(6, frame.cells[0]) && frame.cells[0] >= 1 &&
                frame.cells[0] <= frames)
                numbers.push_back(static_cast<std::size_t>(frame.cells[0]) - 1);
        return numbers;
    };
    /// All frames but `first` to `last`.
    const auto but = [](std::size_t first, std::size_t last) {
        std::vector<std::size_t> numbers;
        for (std::size_t f = 0; f < frames; ++f)
            if (f < first || f > last)
                numbers.push_back(f);
        return numbers;
    };
    const auto decoded = [](const std::string& bytes) {
        return sensors_test::decode(matrix_stream(marked(), immediate), bytes_of(bytes));
    };
    for (std::size_t at = 0; at < stream.size(); ++at) {
        const std::size_t frame = at / size, place = at % size;
        CAPTURE(at);
        for (unsigned bit = 0; bit < 8; ++bit) {
            std::string damaged = stream;
            damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ 1U << bit);
            const auto found = decoded(damaged);
            const bool in_cells = place > marker && place < marker + 7;
            const bool in_marker = place < marker;
            CHECK(whole_frames(found) == (in_cells || in_marker ? but(frame, frame) : but(frames, frames)));
            CHECK(found.frames.size() == frames - (in_marker ? 1 : 0)); // no sum protects cells
            if (in_marker && frame > 0) // bytes before the first frame are of a stream that was joined
                CHECK_FALSE(found.error.empty());
        }
        for (const bool lost : {true, false}) {
            std::string damaged = stream;
            lost ? damaged.erase(at, 1) : damaged.insert(at, 1, damaged[at]);
            const auto found = decoded(damaged);
            const auto left = whole_frames(found);
            const std::vector<std::size_t> least = but(frame, frame + 1);
            CHECK(std::includes(left.begin(), left.end(), least.begin(), least.end()));
            if (frame > 0)
                CHECK_FALSE(found.error.empty());
        }
    }
}

TEST_CASE("matrix_stream: cells that are no pressures, and broken ones") {
    const sensor_description floats{.rows = 1, .columns = 2, .cell = tactnet::cell_type::float32};
    for (const std::string& cell : {"\0\0\x80\x7F"s, "\0\0\x80\xBF"s}) {
        matrix_stream decoder(floats);
        const std::string good(8, '\0');
        CHECK(decoder.push(bytes_of(good + "\0\0\0\0"s + cell + good), tactnet::ignore_frames{}) ==
              decode_status::damaged);
        CHECK(decoder.frames() == 2);
        CHECK(decoder.error().place() == "byte 8, frame 2");
        CHECK(decoder.error().found.find("in row 1, column 2") != std::string::npos);
    }
}

TEST_CASE("matrix_stream: broken cells are NaN, inverted counts are counts") {
    const sensor_description floats{.rows = 1, .columns = 3, .cell = tactnet::cell_type::float32};
    const auto found = cells_of(floats, "\0\0\xC0\x7F\0\0\x80\x3F\0\0\0\0"s);
    CHECK(std::isnan(found[0]));
    CHECK(found[1] == 1.0F);
    // No touch is 2135 counts, a full load 0; a sentinel and a glitch mark broken cells.
    const sensor_description inverted{.rows = 1,
                                      .columns = 6,
                                      .cell = tactnet::cell_type::uint16,
                                      .offset = 2135,
                                      .inverted = true,
                                      .broken = {65535},
                                      .broken_above = 4000};
    const auto counts = cells_of(inverted, "\x57\x08\0\0\x56\x08\x58\x08\xFF\xFF\xA1\x0F"s);
    CHECK(std::vector<float>(counts.begin(), counts.begin() + 4) == std::vector<float>{0, 2135, 1, 0});
    CHECK_FALSE(std::signbit(counts[0]));
    CHECK(std::isnan(counts[4]));
    CHECK(std::isnan(counts[5]));
    const sensor_description below{
        .rows = 1, .columns = 3, .cell = tactnet::cell_type::int8, .offset = -3.5, .broken = {-1}};
    const auto offset = cells_of(below, "\xFC\xFF\x02");
    CHECK(offset[0] == 0.0F);
    CHECK(std::isnan(offset[1]));
    CHECK(offset[2] == 5.5F);
}

TEST_CASE("checksum: the check values of the catalogue of CRC algorithms, and sums") {
    using enum tactnet::checksum_kind;
    for (const auto& [description, sum] : std::vector<std::pair<tactnet::packet_checksum, std::uint16_t>>{
             {{.kind = crc8}, 0xF4},                                        // SMBUS
             {{.kind = crc8, .polynomial = 0x31, .reflected = true}, 0xA1}, // MAXIM-DOW
             {{.kind = crc16}, 0x31C3},                                     // XMODEM
             {{.kind = crc16, .initial = 0xFFFF}, 0x29B1},                  // IBM-3740
             {{.kind = crc16, .polynomial = 0x8005, .initial = 0xFFFF, .reflected = true}, 0x4B37}, // MODBUS
             {{.kind = crc16, .initial = 0xFFFF, .final_xor = 0xFFFF, .reflected = true}, 0x906E}, // IBM-SDLC
             {{.kind = sum16}, 477},
             {{.kind = sum8, .negated = true}, 0x23},
             {{.kind = xor8, .final_xor = 0xFF}, 0xCE}})
        CHECK(tactnet::checksum_of(description)(bytes_of("123456789")) == sum);
}

TEST_CASE("matrix_stream: descriptions that make no sense; memory") {
    CHECK_THROWS_AS(matrix_stream({.rows = 0, .columns = 1}), std::invalid_argument);
    CHECK_THROWS_AS(matrix_stream({.rows = 1025, .columns = 1024}), std::invalid_argument);
    CHECK_THROWS_AS(matrix_stream({.rows = 1, .columns = 1, .trailer_bytes = SIZE_MAX}),
                    std::invalid_argument);
    matrix_stream decoder(marked(), immediate);
    const std::string stream = "MMX_\1\2\3\4\5\6__";
    const std::size_t before = support::bytes_allocated();
    for (int i = 0; i < 1000; ++i)
        decoder.push(bytes_of(stream), tactnet::ignore_frames{});
    CHECK(support::bytes_allocated() == before);
    CHECK(decoder.frames() == 1000);
}

TEST_CASE("matrix_stream: a long marker takes linear time, whatever comes before it") {
    // 6.5 s per megabyte when the marker was compared again from every byte on.
    for (const std::string& repeated : {"A"s, "AB"s, "AAB"s}) {
        sensor_description format = bare;
        std::string marker;
        while (marker.size() < 4000)
            marker += repeated;
        marker += "!";
        format.marker.assign(bytes_of(marker).begin(), bytes_of(marker).end());
        std::string stream;
        while (stream.size() < 4'000'000)
            stream += repeated;
        matrix_stream decoder(format, immediate);
        const std::clock_t start = std::clock();
        decoder.push(bytes_of(stream + "!\1\2\3\4\5\6" + marker), tactnet::ignore_frames{});
        CHECK(std::clock() - start < 10 * CLOCKS_PER_SEC);
        CHECK(decoder.frames() == 1);
        CHECK(decoder.skipped_bytes() == stream.size() + 1 - marker.size());
    }
}

TEST_CASE("matrix_stream: markers of few letters are found as by comparing from every byte on") {
    std::mt19937 random(7);
    for (int trial = 0; trial < 3000; ++trial) {
        const auto letters = [&](std::size_t count) {
            std::string text;
            while (text.size() < count)
                text += "ab"[random() % 2];
            return text;
        };
        sensor_description format{.rows = 1, .columns = 2};
        const std::string marker = letters(1 + random() % 7), stream = letters(random() % 60);
        format.marker.assign(bytes_of(marker).begin(), bytes_of(marker).end());
        matrix_stream decoder(format, immediate);
        decoder.push(bytes_of(stream), tactnet::ignore_frames{});
        const std::size_t packet = marker.size() + 2;
        std::size_t at = 0, end = 0, frames = 0, skipped = 0;
        for (bool in_step = false; at + marker.size() <= stream.size();) {
            if (stream.substr(at).starts_with(marker)) {
                if (at + packet > stream.size())
                    break;
                skipped += at - std::min(at, end);
                end = at += packet;
                ++frames;
                in_step = true;
            } else {
                at = in_step ? at + 1 - packet : at + 1; // again from the next byte
                in_step = false;
            }
        }
        CHECK(decoder.frames() == frames);
        CHECK(decoder.skipped_bytes() == skipped);
    }
}

namespace {

/// Packets of 32 cells, each a function of its number, so that a wrong frame shows. `still` repeats the cells
/// of a scene, which hold the marker.
struct test_stream {
    std::string marker;
    bool still = false;
    tactnet::checksum_kind checksum = tactnet::checksum_kind::none;

    [[nodiscard]] sensor_description description() const {
        sensor_description d{.rows = 4, .columns = 8};
        d.marker.assign(bytes_of(marker).begin(), bytes_of(marker).end());
        d.checksum.kind = checksum;
        return d;
    }
    [[nodiscard]] std::string cells(std::uint32_t number) const {
        std::mt19937 random(still ? number / 40 : number);
        std::string text;
        for (int i = 0; i < 32; ++i)
            text += static_cast<char>(random() % 256);
        if (still && number % 40 < 30)
            text.replace(random() % 25, marker.size(), marker);
        // A number in each frame of a moving scene, in its first cells.
        return text;
    }
    [[nodiscard]] std::string packet(std::uint32_t number) const {
        const std::string begun = marker + cells(number);
        const std::uint16_t sum = tactnet::checksum_of({.kind = checksum})(bytes_of(begun));
        return begun +
               std::string(description().checksum.bytes() > 0 ? 1 : 0, static_cast<char>(sum & 255U)) +
               std::string(description().checksum.bytes() > 1 ? 1 : 0, static_cast<char>(sum >> 8U));
    }
};

struct tally {
    std::uint64_t mutations = 0, certain = 0, wrong = 0, frames = 0;
};

/// A stream in which every fourth packet loses, gains or doubles bytes, or has one changed if `changed`.
tally decode_mutated(const test_stream& of, std::uint32_t packets, std::uint32_t spacing, bool changed) {
    std::mt19937 random(17);
    matrix_stream decoder(of.description());
    tally result;
    std::uint32_t latest = 0;
    const auto check = [&](const tactnet::frame_view& frame) {
        ++result.frames;
        result.certain += frame.certain;
        std::string cells;
        for (const float cell : frame.cells)
            cells += static_cast<char>(static_cast<unsigned char>(cell));
        bool known = false;
        for (std::uint32_t back = 0; back < 24 && back <= latest && !known; ++back)
            known = cells == of.cells(latest - back);
        result.wrong += frame.certain && !known;
    };
    for (std::uint32_t number = 0; number < packets; ++number) {
        std::string packet = of.packet(number);
        if (number == 0)
            packet.erase(0, 7);
        else if (number % spacing == 0) {
            const std::size_t at = random() % packet.size(),
                              most = std::min<std::size_t>(packet.size() - at, 8);
            const std::size_t bytes = random() % 2 == 0 ? 1 : 1 + random() % most;
            ++result.mutations;
            switch (random() % (changed ? 4 : 3)) {
            case 0:
                packet.erase(at, bytes);
                break;
            case 1:
                packet.insert(at, std::string(bytes, static_cast<char>(random() % 256)));
                break;
            case 2:
                packet.insert(at, packet.substr(at, bytes));
                break;
            default:
                packet[at] = static_cast<char>(random() % 256);
            }
        }
        latest = number;
        decoder.push(bytes_of(packet), check);
    }
    decoder.finish(check);
    return result;
}

} // namespace

TEST_CASE(
    "matrix_stream: packets joined anywhere whose cells look like a marker are never certain and wrong") {
    // 16 x 16, marker AA 55, which a still scene has among its cells: two places fit, so that none is
    // certain.
    const sensor_description array{.rows = 16, .columns = 16, .marker = {std::byte{0xAA}, std::byte{0x55}}};
    std::string packet = "\xAA\x55" + std::string(256, '\3');
    packet.replace(100, 2, "\xAA\x55");
    std::string stream;
    for (int i = 0; i < 999; ++i)
        stream += packet;
    std::string moved = packet;
    moved.replace(100, 2, "\3\3");
    for (const std::size_t join : {0U, 1U, 50U, 99U, 101U, 200U}) {
        const auto still = sensors_test::decode(matrix_stream(array), bytes_of(stream.substr(join)));
        CHECK(still.certain_frames == 0);
        // Once the scene moves, one place is left.
        std::uint64_t right = 0, wrong = 0;
        matrix_stream decoder(array);
        const auto count = [&](const tactnet::frame_view& frame) {
            const bool whole = frame.cells[0] == 3.0F && frame.cells[255] == 3.0F && frame.cells[97] == 3.0F;
            right += frame.certain && whole && (frame.cells[98] == 3.0F || frame.cells[98] == 170.0F);
            wrong += frame.certain && !whole;
        };
        decoder.push(bytes_of(stream.substr(join)), count);
        CHECK(decoder.error().found == "two or more that fit");
        for (int i = 0; i < 20; ++i)
            decoder.push(bytes_of(moved), count);
        CHECK(right >= 15);
        CHECK(wrong == 0);
    }
}

TEST_CASE("matrix_stream: the packets of the issue") {
    const sensor_description array{.rows = 1, .columns = 4, .marker = {std::byte{'T'}, std::byte{'N'}}};
    const auto found =
        sensors_test::decode(matrix_stream(array), bytes_of("TN\1\2\4TN\5\6\7\10TN\11\12\13\14"));
    REQUIRE(found.frames.size() == 2); // the first lost a byte
    CHECK(found.frames[0].cells == std::vector<float>{5, 6, 7, 8});
    CHECK(found.certain_frames == 1); // nothing follows the last
}

TEST_CASE("matrix_stream: wrong frames that are certain, per million mutations") {
    using enum tactnet::checksum_kind;
    for (const std::string marker : {"TN", "AA", "\xFF"})
        for (const bool still : {false, true})
            for (const auto checksum : {none, crc16, xor8, sum8}) {
                const tally found = decode_mutated({marker, still, checksum}, 60'000, 3, checksum != none);
                CAPTURE(marker);
                CAPTURE(still);
                CAPTURE(found.wrong);
                CAPTURE(found.mutations);
                // A checksum of eight bits misses one of 256 wrong packets.
                const bool short_sum = checksum == xor8 || checksum == sum8;
                const auto mutations = static_cast<double>(found.mutations);
                CHECK(static_cast<double>(found.wrong) <= mutations * (short_sum ? 1.2 / 256 : 1e-4));
                // Where damage is rarer, nearly all frames that are whole are delivered.
                const tally rare = decode_mutated({marker, still, checksum}, 6'000, 20, checksum != none);
                CHECK(rare.wrong <= (short_sum ? 4 : 0));
                if (checksum != none ? checksum != xor8 : !still)
                    CHECK(rare.certain >= 5'000);
            }
}
