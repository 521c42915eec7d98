#include <tactnet/sensors/tekscan/line.hpp>

#include <doctest/doctest.h>

#include <string>
#include <string_view>

namespace {

using tactnet::tekscan_line;
using tactnet::tekscan_part;
using kind = tactnet::tekscan_line_kind;

std::string unquoted;

tekscan_line read(std::string_view text) {
    return tactnet::read_data_line({.text = text, .byte = 7, .number = 3}, unquoted);
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
    const auto line = tactnet::read_header_line("\"ROW_SPACING\",0.127,centimeters,,", unquoted);
    CHECK(line.key == "ROW_SPACING");
    CHECK(line.value == "0.127,centimeters");
    CHECK(line.text == "ROW_SPACING,0.127,centimeters");
    CHECK((line.followed_by == tekscan_part::header));
    const auto after = [](std::string_view text) {
        return tactnet::read_header_line(text, unquoted).followed_by;
    };
    CHECK((after(" ASCII_DATA\t@@ ,,") == tekscan_part::cells));
    CHECK((after("ASCII_DATA") == tekscan_part::cells));
    CHECK((after("SENSOR_MAP @@") == tekscan_part::map));
    CHECK((after("ASCII_DATA of my robot") == tekscan_part::header));
}

} // namespace
