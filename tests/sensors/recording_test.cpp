#include "decoded.hpp"

#include <tactnet/io/write_file.hpp>
#include <tactnet/sensors/any_recording.hpp>
#include <tactnet/sensors/recording.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>

namespace {

using namespace std::string_literals;
using sensors_test::bytes_of;
using tactnet::any_recording;
using tactnet::decode_all;
using tactnet::decode_status;
using tactnet::file_error;
using tactnet::read_recording;
using tactnet::shape;

const std::string timed_text =
    "ROWS 1\nCOLS 2\nSTART_FRAME 1\nEND_FRAME 2\nSECONDS_PER_FRAME 0.5\nASCII_DATA "
    "@@\nFrame 1\n1,2\nFrame 2\n3,4\n@@\n";

TEST_CASE("recording: frames in a size known when running, and when compiling") {
    const auto recording = decode_all(tactnet::any_recording(), bytes_of(timed_text));
    CHECK(!recording.damage);
    REQUIRE(recording.size() == 2);
    CHECK(recording[1].number == 2);
    CHECK(recording[1].seconds == 0.5);
    CHECK(recording[1](0, 1) == 4);
    CHECK(recording.as<shape{1, 2, 1}>(0)(0, 0) == 1);
    CHECK_THROWS_WITH_AS(static_cast<void>(recording.as<shape{28, 50, 1}>(0)),
                         "recording: expected frames of 28 x 50, found 1 x 2", std::invalid_argument);
    CHECK_THROWS_WITH_AS(static_cast<void>(recording[2]), "recording: expected a frame below 2, found 2",
                         std::out_of_range);
}

TEST_CASE("recording: files: refused when damaged, or read as far as they are whole") {
    const support::temporary_folder folder;
    const auto path = folder / "not what it says.fsx";
    tactnet::write_file(path, timed_text);
    CHECK(read_recording(path).size() == 2);
    tactnet::write_file(path, timed_text.substr(0, timed_text.find("3,4")));
    CHECK_THROWS_WITH_AS(static_cast<void>(read_recording(path)),
                         (path.string() + ": byte " + std::to_string(timed_text.find("3,4") - 1) +
                          ", line 9, frame 2: expected 1 rows, found 0 before the end of the data "
                          "(1 announced frames are missing)")
                             .c_str(),
                         file_error);
    const auto kept = read_recording(path, tactnet::damaged_file::keep_whole_frames);
    REQUIRE(kept.size() == 1);
    REQUIRE(kept.damage);
    CHECK(kept.damage->missing_frames == 1);
    CHECK(kept[0](0, 0) == 1);
    CHECK(kept.certain_frames == 1);
    tactnet::write_file(path, "");
    CHECK_THROWS_AS(static_cast<void>(read_recording(path, tactnet::damaged_file::keep_whole_frames)),
                    file_error);
    CHECK_THROWS_AS(static_cast<void>(read_recording(folder.path())), file_error);
    CHECK_THROWS_AS(static_cast<void>(read_recording(folder / "none")), file_error);
}

TEST_CASE("recording: a few bytes cannot ask for all memory") {
    // Every empty frame of a binary recording is four bytes.
    std::string bytes = "ROWS 250\nCOLS 250\n\xBB\xBA";
    for (int i = 0; i < 100'000; ++i)
        bytes += "\xFF\xFF\xFF\xFF";
    const auto recording = decode_all(tactnet::any_recording(), bytes_of(bytes), 1'000'000);
    CHECK(recording.size() == 16);
    REQUIRE(recording.damage);
    CHECK(recording.damage->expected == "at most 1000000 cells");
}

TEST_CASE("recording: the real ones" * doctest::test_suite("data")) {
    if (const auto path = support::find_data("tekscan/iscan_test.csv"))
        CHECK(read_recording(*path).size() == 309);
    if (const auto path = support::find_data("tekscan/MySampleRecording.fsx")) {
        const auto binary = read_recording(*path);
        CHECK(binary.as<shape{44, 52, 1}>(0)(15, 34) == 10);
    }
    if (const auto path = support::find_data("tekscan/null.mp"))
        CHECK(read_recording(*path).description.missing_cells() == 0);
}

TEST_CASE("recording: warnings, and which frames are certain, of formats that know doubts") {
    const std::string header = "ROWS 1\nCOLS 2\nNOISE_THRESHOLD 3\nSECONDS_PER_FRAME 1\nFRAMES 3\n\xBB\xBA",
                      frame = "\x00\x00\x01\x07\xFF\xFF\xFF\xFF"s,
                      quiet = "\x00\x00\x01\x02\xFF\xFF\xFF\xFF"s;
    const auto odd =
        decode_all(tactnet::any_recording(), bytes_of(header + frame + frame + quiet + "\xFF\xFE"));
    CHECK(!odd.damage);
    CHECK(odd.warnings.count() == 1);
    CHECK(odd.warnings.kept()[0].frame == 3);
    CHECK(odd.certain_frames == 1);
    const auto cut = decode_all(tactnet::any_recording(), bytes_of(header + frame + frame));
    CHECK(cut.size() == 2);
    CHECK(cut.certain_frames == 1);
    // What is not kept is not certain either.
    const auto full =
        decode_all(tactnet::any_recording(), bytes_of(header + frame + frame + frame + "\xFF\xFE"), 2);
    CHECK(full.size() == 1);
    CHECK(full.certain_frames == 1);
}

const std::string text = "ROWS 1\r\nCOLS 2\r\nASCII_DATA @@\r\nFrame 1\r\n1,2\r\nFrame 2\r\n3,4\r\n@@\r\n";
const std::string binary = "ROWS 1\nCOLS 2\n\xBB\xBA\x01\x00\x01\x07\xFF\xFF\xFF\xFF\xFF\xFE"s;
const std::string map = "ROWS 1\nCOLS 2\nSENSOR_MAP @@\n0,B\n@@\n";

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

} // namespace
