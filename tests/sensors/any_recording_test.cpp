#include "decoded.hpp"

#include <tactnet/sensors/any_recording.hpp>

#include <doctest/doctest.h>

#include <string>
#include <support/allocations.hpp>

using sensors_test::bytes_of;
using tactnet::any_recording;
using tactnet::decode_status;
using namespace std::string_literals;

namespace {

const std::string text = "ROWS 1\r\nCOLS 2\r\nASCII_DATA @@\r\nFrame 1\r\n1,2\r\nFrame 2\r\n3,4\r\n@@\r\n";
const std::string binary = "ROWS 1\nCOLS 2\n\xBB\xBA\x01\x00\x01\x07\xFF\xFF\xFF\xFF\xFF\xFE"s;
const std::string map = "ROWS 1\nCOLS 2\nSENSOR_MAP @@\n0,B\n@@\n";

} // namespace

static_assert(tactnet::frame_decoder<any_recording>);

TEST_CASE("any_recording: the format is detected from the content, however it is split") {
    const auto check = [](const std::string& bytes, const std::string& format, std::size_t frames) {
        const auto found = sensors_test::decode(any_recording(), bytes_of(bytes));
        CHECK_MESSAGE(found.status == decode_status::finished, found.error);
        CHECK(found.description.format == format);
        CHECK(found.frames.size() == frames);
        CHECK(sensors_test::same_however_split(any_recording(), bytes_of(bytes)));
    };
    check(text, "Tekscan ASCII", 2);
    check(binary, "Tekscan binary", 1);
    check(map, "Tekscan map", 0);
    check("\"ROWS 1\",\n\"COLS 2\",\n\"ASCII_DATA @@\",\n1,2\n", "Tekscan ASCII", 1);
    check("ROWS 1\nCOLS 2\n ASCII_DATA @@\n1,2\n", "Tekscan ASCII", 1);
    check("ROWS 1\r\nCOLS 2\r\nASCII_DATA\r\n1,2\r\n", "Tekscan ASCII", 1);
    // Only a line of its own counts.
    for (const std::string line :
         {"FILENAME x.ASCII_DATA", "COMMENTS seen as ASCII_DATA @@", "ASCII_DATA_VERSION 3",
          "SENSOR_MAP_FILE a.mp", "COMMENTS:\nASCII_DATA by hand\nSENSOR_MAP lost", "MARK \xBB\xBA"}) {
        CAPTURE(line);
        check(line + "\n" + binary, "Tekscan binary", 1);
        check(line + "\r\n" + text, "Tekscan ASCII", 2);
        check(line + "\n" + map, "Tekscan map", 0);
    }
}

TEST_CASE("any_recording: errors are one sentence, also for a missing file") {
    any_recording none;
    CHECK(none.finish(tactnet::ignore_frames()) == decode_status::damaged);
    const std::string sentence = "byte 0: expected a Tekscan recording or map (a line 'ASCII_DATA @@' or "
                                 "'SENSOR_MAP @@', or bytes 0A BB "
                                 "BA), found not a single byte, as from a file that is empty or not there";
    CHECK(none.error().message() == sentence);
    CHECK(none.error().message("glove.fsx") == "glove.fsx: " + sentence);
    any_recording cut;
    CHECK(cut.push(
              bytes_of("ROWS 1\nCOLS 2\nSTART_FRAME 1\nEND_FRAME 2\nASCII_DATA @@\nFrame 1\n1,2\nFrame 2\n"),
              tactnet::ignore_frames()) == decode_status::reading);
    CHECK(cut.finish(tactnet::ignore_frames()) == decode_status::damaged);
    CHECK(cut.error().message() == cut.error().place() + ": expected " + cut.error().expected + ", found " +
                                       cut.error().found + " (1 announced frames are missing)");
}

TEST_CASE("any_recording: a header without frames is detected by its last line") {
    for (const std::string end : {"", "\n", "\r"})
        CHECK(sensors_test::decode(any_recording(), bytes_of("ROWS 1\nCOLS 2\nASCII_DATA @@" + end))
                  .error.find("expected 1 frames, found 0 before the end of the data") != std::string::npos);
}

TEST_CASE("any_recording: a map's mask goes to binary recordings") {
    const auto found = sensors_test::decode(any_recording({1, 0}), bytes_of(binary));
    CHECK(found.error.find("expected counts on tactels of the map only") != std::string::npos);
    CHECK(sensors_test::decode(any_recording({0, 1}), bytes_of(binary)).frames.size() == 1);
}

TEST_CASE("any_recording: anything else is refused, with no more of it kept than a header") {
    for (const std::string& bytes :
         {""s, "x"s, "\xBB\xBA\xFF\xFE"s, "ROWS 1\nCOLS 2\nASCII"s, std::string(1'000'000, 'x')}) {
        const auto found = sensors_test::decode(any_recording(), bytes_of(bytes));
        CHECK(found.status == decode_status::damaged);
        CHECK(found.error.find("expected a Tekscan recording or map") != std::string::npos);
    }
    const std::string large(10'000'000, 'x');
    any_recording decoder;
    const std::size_t before = support::bytes_allocated();
    CHECK(decoder.push(bytes_of(large), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(support::bytes_allocated() - before < 2 * tactnet::largest_header_bytes);
}
