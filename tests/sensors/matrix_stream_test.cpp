#include "decoded.hpp"

#include <tactnet/sensors/matrix_stream.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <string>
#include <string_view>
#include <support/allocations.hpp>
#include <vector>

using sensors_test::bytes_of;
using tactnet::decode_status;
using tactnet::matrix_stream;
using tactnet::matrix_stream_format;
using namespace std::string_literals;

namespace {

const matrix_stream_format bare{.rows = 2, .columns = 3};

matrix_stream_format marked() {
    matrix_stream_format format{.rows = 2, .columns = 3};
    format.marker = {std::byte{'M'}, std::byte{'M'}, std::byte{'X'}};
    format.skip_before = 1;
    format.skip_after = 2;
    format.seconds_per_frame = 0.5;
    return format;
}

std::vector<float> cells_of(const matrix_stream_format& format, const std::string& bytes) {
    const auto found = sensors_test::decode(matrix_stream(format), bytes_of(bytes));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 1);
    return found.frames[0].cells;
}

} // namespace

static_assert(tactnet::frame_decoder<matrix_stream>);

TEST_CASE("matrix_stream: every form of a cell, row by row or column by column") {
    using enum tactnet::cell_format;
    const std::vector<float> counted{1, 2, 3, 4, 5, 6};
    CHECK(cells_of(bare, "\1\2\3\4\5\6") == counted);
    CHECK(cells_of({.rows = 2, .columns = 3, .order = tactnet::cell_order::columns}, "\1\4\2\5\3\6") ==
          counted);
    CHECK(cells_of({.rows = 1, .columns = 2, .cell = uint16_little}, "\1\2\xFF\xFF") ==
          std::vector<float>{513, 65535});
    CHECK(cells_of({.rows = 1, .columns = 2, .cell = uint16_big}, "\1\2\xFF\xFE") ==
          std::vector<float>{258, 65534});
    CHECK(cells_of({.rows = 1, .columns = 2, .cell = float32_little}, "\0\0\xC0\x3F\0\0\0\0"s) ==
          std::vector<float>{1.5F, 0});
}

TEST_CASE("matrix_stream: markers: joined anywhere, lost and found again") {
    const std::string one = "MMX_\1\2\3\4\5\6__", two = "MMX_\6\5\4\3\2\1__";
    const auto whole = sensors_test::decode(matrix_stream(marked()), bytes_of(one + two));
    REQUIRE(whole.frames.size() == 2);
    CHECK(whole.frames[1].cells == std::vector<float>{6, 5, 4, 3, 2, 1});
    CHECK(whole.frames[1].seconds == 0.5);
    CHECK(whole.status == decode_status::finished);
    // A marker that begins inside what looked like one.
    matrix_stream joined(marked());
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
        return sensors_test::decode(matrix_stream(marked()), bytes_of(bytes));
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

TEST_CASE("matrix_stream: cells that are no pressures") {
    const matrix_stream_format floats{.rows = 1, .columns = 2, .cell = tactnet::cell_format::float32_little};
    for (const std::string& cell : {"\0\0\xC0\x7F"s, "\0\0\x80\x7F"s, "\0\0\x80\xBF"s}) {
        matrix_stream decoder(floats);
        const std::string good(8, '\0');
        CHECK(decoder.push(bytes_of(good + "\0\0\0\0"s + cell + good), tactnet::ignore_frames{}) ==
              decode_status::damaged);
        CHECK(decoder.frames() == 2);
        CHECK(decoder.error().place() == "byte 8, frame 2");
        CHECK(decoder.error().found.find("in row 1, column 2") != std::string::npos);
    }
}

TEST_CASE("matrix_stream: descriptions that make no sense; memory") {
    CHECK_THROWS_AS(matrix_stream({.rows = 0, .columns = 1}), std::invalid_argument);
    CHECK_THROWS_AS(matrix_stream({.rows = 1025, .columns = 1024}), std::invalid_argument);
    CHECK_THROWS_AS(matrix_stream({.rows = 1, .columns = 1, .skip_after = SIZE_MAX}), std::invalid_argument);
    matrix_stream decoder(marked());
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
        matrix_stream_format format = bare;
        std::string marker;
        while (marker.size() < 4000)
            marker += repeated;
        marker += "!";
        format.marker.assign(bytes_of(marker).begin(), bytes_of(marker).end());
        std::string stream;
        while (stream.size() < 4'000'000)
            stream += repeated;
        matrix_stream decoder(format);
        const auto start = std::chrono::steady_clock::now();
        decoder.push(bytes_of(stream + "!\1\2\3\4\5\6" + marker), tactnet::ignore_frames{});
        CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
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
        matrix_stream_format format{.rows = 1, .columns = 2};
        const std::string marker = letters(1 + random() % 7), stream = letters(random() % 60);
        format.marker.assign(bytes_of(marker).begin(), bytes_of(marker).end());
        matrix_stream decoder(format);
        decoder.push(bytes_of(stream), tactnet::ignore_frames{});
        std::size_t at = 0, frames = 0, skipped = 0;
        while (at < stream.size() && !std::string_view(marker).starts_with(stream.substr(at)))
            if (!stream.substr(at).starts_with(marker))
                ++at, ++skipped;
            else if ((at += marker.size() + 2) <= stream.size())
                ++frames;
        CHECK(decoder.frames() == frames);
        CHECK(decoder.skipped_bytes() == skipped);
    }
}
