#include "decoded.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/tekscan/line.hpp>
#include <tactnet/sensors/tekscan/map.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <support/files/data_folder.hpp>
#include <vector>

namespace {

using sensors_test::bytes_of;
using sensors_test::decoded;
using tactnet::decode_status;
using tactnet::tekscan_frame_line;
using tactnet::tekscan_frame_times;
using tactnet::tekscan_line;
using tactnet::tekscan_map;
using tactnet::tekscan_part;

using kind = tactnet::tekscan_line_kind;

std::string unquoted;

tekscan_line read(std::string_view text) {
    return tactnet::detail::read_data_line({.text = text, .byte = 7, .number = 3}, unquoted);
}

TEST_CASE("read_data_line: what each line is, with or without what spreadsheets add") {
    for (const std::string_view row : {"B,5,0", "0", "12.5;3", "1,2,1,,,"})
        CHECK((read(row).kind == kind::row));
    for (const std::string_view blank : {"", " \t", ",,,,", ";;", "\"\"", "\x1A"})
        CHECK((read(blank).kind == kind::blank));
    for (const std::string_view end : {"@@", " @@ ", "@@,,,", "\"@@\""})
        CHECK((read(end).kind == kind::end_mark));
    for (const std::string_view frame : {"Frame 1", "frame,2", "\"FRAME 3\",,", "Frame x"})
        CHECK((read(frame).kind == kind::frame));
    for (const std::string_view other : {"\"B\",5", " 1,2", "b", ".5", "Frames 1", "Frame", "@", "x"})
        CHECK((read(other).kind == kind::other));
    CHECK(read("B,5").source.byte == 7);
    CHECK(read("B,5").source.number == 3);
}

TEST_CASE("read_data_line: a frame line is read at once, and empty if it makes no sense") {
    const auto line = read("\"Frame 4\", 100 ms,, 12/2/2019,,,Raw Sum=,,310,,");
    REQUIRE(line.frame);
    CHECK(line.frame->number == 4);
    CHECK(line.frame->stamp == 100.0);
    CHECK(line.frame->stamp_unit == 1e-3);
    CHECK(line.frame->raw_sum == 310.0);
    CHECK(!read("Frame x").frame);
    CHECK(!read("Frame 1, 0,1").frame);
    CHECK(!read("B,5").frame);
}

TEST_CASE("read_data_line: in messages a line is quoted and cut, the end of the data is not") {
    CHECK(read("\"x\",,").shown() == "'x'");
    CHECK(read("abcdefghijklmnopqrstuvwxyz").shown() == "'abcdefghijklmnopqrst…'");
    CHECK(read("abcdefghijklmnopqrstuvwxyz").shown(80) == "'abcdefghijklmnopqrstuvwxyz'");
    CHECK(tekscan_line{}.shown() == "the end of the data");
}

TEST_CASE("read_header_line: key, value, and whether the data begin") {
    const auto line = tactnet::detail::read_header_line("\"ROW_SPACING\",0.127,centimeters,,", unquoted);
    CHECK(line.key == "ROW_SPACING");
    CHECK(line.value == "0.127,centimeters");
    CHECK(line.text == "ROW_SPACING,0.127,centimeters");
    CHECK((line.followed_by == tekscan_part::header));
    const auto after = [](std::string_view text) {
        return tactnet::detail::read_header_line(text, unquoted).followed_by;
    };
    CHECK((after(" ASCII_DATA\t@@ ,,") == tekscan_part::cells));
    CHECK((after("ASCII_DATA") == tekscan_part::cells));
    CHECK((after("SENSOR_MAP @@") == tekscan_part::map));
    CHECK((after("ASCII_DATA of my robot") == tekscan_part::header));
}

tekscan_frame_line line(std::uint64_t number, std::optional<double> stamp = {},
                        std::optional<double> unit = {}) {
    tekscan_frame_line result;
    result.number = number;
    result.stamp = stamp;
    result.stamp_unit = unit;
    return result;
}

TEST_CASE("tekscan_frame_times: without times, frames have the interval of the header") {
    tekscan_frame_times times;
    times.begin(line(7));
    CHECK(times.seconds(line(7), 0, 0.25) == 0.0);
    CHECK(times.seconds(line(11), 1, 0.25) == 1.0);
    CHECK(times.seconds(line(11), 1, std::nullopt) == std::nullopt);
}

TEST_CASE("tekscan_frame_times: a time with a unit is read as it is") {
    tekscan_frame_times times;
    times.begin(line(1, 500.0, 1e-3));
    CHECK(times.seconds(line(1, 500.0, 1e-3), 0, 0.25) == 0.5);
    CHECK(times.seconds(line(2, 2.0, 1.0), 1, 0.25) == 2.0);
}

TEST_CASE(
    "tekscan_frame_times: without a unit, seconds unless the header shows milliseconds, and it stays so") {
    tekscan_frame_times seconds, milliseconds, unknown;
    for (tekscan_frame_times* const times : {&seconds, &milliseconds, &unknown})
        times->begin(line(1, 0.0));
    CHECK(seconds.seconds(line(1, 0.0), 0, 0.5) == 0.0);
    CHECK(seconds.seconds(line(3, 1.0), 1, 0.5) == 1.0);
    CHECK(milliseconds.seconds(line(3, 1000.0), 1, 0.5) == 1.0);
    CHECK(milliseconds.seconds(line(4, 4.0), 2, 0.5) == 0.004);
    CHECK(unknown.seconds(line(3, 1000.0), 1, std::nullopt) == 1000.0);
}

decoded decode(std::string_view text) {
    return sensors_test::decode(tekscan_map(), bytes_of(text));
}

const std::string map_header =
    "SENSOR_TYPE NULL\r\nROWS 2\r\nCOLS 3\r\nSENSEL_AREA 1\r\nCOMMENT @@\r\n\tROWS 9\r\n@@\r\n"
    "MAP_VERSION 6.4\r\nSENSOR_MAP @@\r\n";

static_assert(tactnet::frame_decoder<tekscan_map>);

TEST_CASE("tekscan_map: the cells that exist, in lines of any length") {
    for (const std::string places :
         {"0, 2, 4\r\n1, 3, 5\r\n", "0,2,4,1\n3 5\n", "0\t2\t4\n\n1\n3,\n5,,,\n"}) {
        const auto found = decode(map_header + places + "@@\r\n");
        CHECK_MESSAGE(found.status == decode_status::finished, found.error);
        CHECK(found.frames.empty());
        CHECK(found.description.mask == std::vector<std::uint8_t>(6, 1));
    }
    CHECK(decode("UNITS bananas\n" + map_header + "0,1,2,3,4,5\n@@\n").status == decode_status::finished);
    tekscan_map map;
    const std::string text = map_header + "7, -1, 4\nB, 65535, 0\n@@\n";
    map.push(bytes_of(text), tactnet::ignore_frames{});
    CHECK(map.finish(tactnet::ignore_frames{}) == decode_status::finished);
    CHECK(map.description().mask == std::vector<std::uint8_t>{1, 0, 1, 0, 0, 1});
    CHECK(map.description().missing_cells() == 3);
    CHECK(std::vector<std::uint16_t>(map.places().begin(), map.places().end()) ==
          std::vector<std::uint16_t>{7, 65535, 4, 65535, 65535, 0});
    CHECK(sensors_test::same_however_split(tekscan_map(), bytes_of(text)));
    CHECK(decode(text + "MORE of its own\n").status == decode_status::finished);
    const std::string cut = map_header + "7, -1";
    CHECK(decode(cut).error == "byte " + std::to_string(cut.size()) +
                                   ", line 11: expected 6 places and a closing '@@', found the end of the "
                                   "data after 2 places");
    // Without the closing line it is cut short; cut inside it is as well.
    for (std::size_t size = 0; size < text.size() - 3; ++size)
        CHECK(decode(text.substr(0, size)).status == decode_status::damaged);
}

TEST_CASE("tekscan_map: those that make no sense") {
    const auto error = [](const std::string& places) { return decode(map_header + places + "@@\n").error; };
    CHECK(error("0,1,2,3,4\n").find("expected 6 places, found 5 before '@@'") != std::string::npos);
    CHECK(error("0,1,2,3,4,5,6\n").find("line 10: expected 6 places, found more") != std::string::npos);
    CHECK(error("0,1,2,3,4,4\n").find("expected one cell at each place, found two at place 4") !=
          std::string::npos);
    for (const std::string place : {"65536", "x", "1.5", "", "--1"})
        CHECK(error("0,1," + place + ",3,4,5\n").find("a place from 0 to 65534, or B") != std::string::npos);
    CHECK(decode("ROWS 1\nCOLS 1\nASCII_DATA @@\n1\n").error.find("expected a line 'SENSOR_MAP @@'") !=
          std::string::npos);
    CHECK(decode("SENSOR_MAP @@\n").error ==
          "byte 0, line 1: expected a line 'ROWS' in the header, found none");
}

TEST_CASE("tekscan_map: the real one" * doctest::test_suite("data")) {
    const auto path = support::find_data("tekscan/null.mp");
    if (!path)
        return;
    const auto bytes = tactnet::read_file(*path);
    tekscan_map map;
    map.push(bytes, tactnet::ignore_frames{});
    REQUIRE(map.finish(tactnet::ignore_frames{}) == decode_status::finished);
    CHECK(map.description().cells() == 44 * 52);
    CHECK(map.description().missing_cells() == 0);
    CHECK(map.places()[1] == 44);
    CHECK(map.places().back() == 2287);
}

} // namespace
