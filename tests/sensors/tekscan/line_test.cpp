#include <tactnet/sensors/tekscan/line.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace {

using tactnet::tekscan_line;
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

} // namespace

namespace {

using tactnet::tekscan_frame_line;
using tactnet::tekscan_frame_times;

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

} // namespace
