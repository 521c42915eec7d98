#include <tactnet/io/write_file.hpp>
#include <tactnet/sensors/recording.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <string>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>

using tactnet::decode_all;
using tactnet::file_error;
using tactnet::read_recording;
using tactnet::shape;
using namespace std::string_literals;

namespace {

const std::string text = "ROWS 1\nCOLS 2\nSTART_FRAME 1\nEND_FRAME 2\nSECONDS_PER_FRAME 0.5\nASCII_DATA "
                         "@@\nFrame 1\n1,2\nFrame 2\n3,4\n@@\n";

std::span<const std::byte> bytes_of(const std::string& bytes) {
    return std::as_bytes(std::span(bytes));
}

} // namespace

TEST_CASE("recording: frames in a size known when running, and when compiling") {
    const auto recording = decode_all(tactnet::any_recording(), bytes_of(text));
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
    tactnet::write_file(path, text);
    CHECK(read_recording(path).size() == 2);
    tactnet::write_file(path, text.substr(0, text.find("3,4")));
    CHECK_THROWS_WITH_AS(static_cast<void>(read_recording(path)),
                         (path.string() + ": byte " + std::to_string(text.find("3,4") - 1) +
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
