#include "../decoded.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/sensors/described/text_stream.hpp>
#include <tactnet/sensors/recording.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <support/allocations.hpp>
#include <vector>

using sensors_test::bytes_of, sensors_test::decode;
using tactnet::decode_status, tactnet::parse_sensor, tactnet::text_stream;

namespace {

const std::vector<float> counted{0, 1, 2, 3, 4, 5};

std::vector<float> cells_of(const std::string& description, const std::string& text) {
    CAPTURE(text);
    const text_stream decoder(parse_sensor(description));
    const auto found = decode(decoder, bytes_of(text));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 1);
    CHECK(sensors_test::same_however_split(decoder, bytes_of(text)));
    return found.frames[0].cells;
}

} // namespace

TEST_CASE("text_stream: separators, trailing ones, signs, fractions, decimal commas") {
    const std::string plain = R"({"rows": 2, "columns": 3, "cell": "digits"})";
    for (const std::string text :
         {"0,1,2,3,4,5\n", "0, 1, 2, 3, 4, 5\r\n", "0\t1\t2\t3\t4\t5\t\r\n", "0 1 2  3 4 5", " 0;1;2;3;4;5;",
          "0 ,1 , 2,3,4 ,5,\n", "0.0,1e0,+2,3.000,04,5"})
        CHECK(cells_of(plain, text) == counted);
    CHECK(cells_of(R"({"rows": 1, "columns": 2, "cell": "digits", "decimal_comma": true})", "1,5;2,25\n") ==
          std::vector<float>{1.5F, 2.25F});
    const auto description =
        parse_sensor(R"({"rows": 1, "columns": 3, "cell": "digits", "broken": ["nan", -1]})");
    const auto broken = decode(text_stream(description), bytes_of("nan,-1,7\n")).frames.at(0).cells;
    CHECK(std::isnan(broken[0]));
    CHECK(std::isnan(broken[1]));
    CHECK(broken[2] == 7);
}

TEST_CASE("text_stream: labels and time stamps; rows by lines; an order of the cells") {
    CHECK(cells_of(R"({"rows": 2, "columns": 3, "cell": "digits", "leading_fields": 1})",
                   "P: 0,1,2,3,4,5\n") == counted);
    const auto stamped = decode(
        text_stream(parse_sensor(
            R"({"rows": 1, "columns": 2, "cell": "digits", "leading_fields": 2, "seconds_per_tick": 0.001})")),
        bytes_of("1500,A,7,8\n1510,A,9,10\n"));
    REQUIRE(stamped.frames.size() == 2);
    CHECK(stamped.frames[1].seconds == doctest::Approx(1.51));
    CHECK(stamped.frames[1].cells == std::vector<float>{9, 10});
    const std::string rows =
        R"({"rows": 2, "columns": 3, "cell": "digits", "line": "row", "header_lines": 1})";
    CHECK(cells_of(rows, "a,b,c\n0,1,2\n3,4,5\n") == counted);
    CHECK(cells_of(rows, "a,b,c\n\n0,1,2\n3,4,5\n\n") == counted);
    CHECK(cells_of(R"({"rows": 2, "columns": 3, "cell": "digits", "serpentine": true})", "0 1 2 5 4 3\n") ==
          counted);
}

TEST_CASE("text_stream: joined anywhere, damaged lines, and what is no such text") {
    const auto lines = parse_sensor(R"({"rows": 1, "columns": 3, "cell": "digits"})");
    const auto decoded = [&](const std::string& text) { return decode(text_stream(lines), bytes_of(text)); };
    const auto joined = decoded("23,4\n1,2,3\n4,5,6\n");
    CHECK(joined.status == decode_status::finished);
    CHECK(joined.frames.size() == 2);
    text_stream live(lines);
    CHECK(live.push(bytes_of("1,2,3\n4,56\n7,8,9\n"), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(live.frames() == 2);
    CHECK(live.error().message() == "byte 6, line 2, frame 2: expected 3 numbers, found 2");
    CHECK(live.push(bytes_of("1,2,3,4\n"), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(live.error().message() == "byte 17, line 4, frame 3: expected 3 numbers, found more");
    CHECK(live.push(bytes_of("1,x,3\n"), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(live.error().message() == "byte 25, line 5, frame 3: expected a number in field 2, found 'x,3'");
    CHECK(live.push(bytes_of("1,-2,3\n"), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(live.error().message() ==
          "byte 31, line 6, frame 3: expected cells of zero or more, found -2.000000 in field 2");
    CHECK(decoded("1,-2,-3\n4,5,6\n").error == // numbers are no header that may be skipped
          "byte 0, line 1, frame 1: expected cells of zero or more, found -2.000000 in field 2");
    CHECK(decode(text_stream(parse_sensor(R"({"rows": 1, "columns": 2, "cell": "digits", "leading_fields": 1,
                                              "seconds_per_tick": 10})")),
                 bytes_of("1e307,1,2\n1e308,1,2\n"))
              .error == "byte 10, line 2, frame 2: expected a time stamp, found '1e308,1,2'");
    CHECK(decoded("hello\nworld\n").error ==
          "byte 0, line 1, frame 1: expected a number in field 1, found 'hello'");
    const auto rows = parse_sensor(R"({"rows": 2, "columns": 2, "cell": "digits", "line": "row"})");
    const auto cut = decode(text_stream(rows), bytes_of("1,2\n3,4\n\n5,6\n\n7,8\n9,10\n\n11,12\n"));
    CHECK(cut.frames.size() == 2);
    CHECK(cut.error == "byte 24, line 9, frame 3: expected 2 rows of a frame, found 1 of them");
    CHECK(sensors_test::same_however_split(text_stream(rows),
                                           bytes_of("1,2\n3,4\n\n5,6\n\n7,8\n9,10\n\n11,12\n")));
    CHECK_THROWS_AS(text_stream({.rows = 1, .columns = 1}), std::invalid_argument);
    text_stream steady(lines);
    steady.push(bytes_of("1,2,3\n"), tactnet::ignore_frames{});
    const std::size_t before = support::bytes_allocated();
    for (int i = 0; i < 1000; ++i)
        steady.push(bytes_of("1,2,3\n"), tactnet::ignore_frames{});
    CHECK(support::bytes_allocated() == before);
}

TEST_CASE("text_stream: three invented layouts, by a description alone") {
    // A glove that scans columns in serpentines and sends 12-bit counts that fall under pressure.
    const auto glove =
        cells_of(R"({"rows": 3, "columns": 2, "cell": "digits", "order": "columns", "serpentine": true,
                                    "offset": 3072, "inverted": true, "leading_fields": 1})",
                 "glove> 3072 3062 3072 3072 0 3075\n");
    CHECK(glove == std::vector<float>{0, 0, 10, 3072, 0, 0});
    // A seat of two halves in a European spreadsheet, a row a line, upside down.
    const auto seat =
        cells_of(R"({"rows": 2, "columns": 4, "cell": "digits", "line": "row", "blocks": "stacked",
                                   "decimal_comma": true, "header_lines": 2, "flipped_rows": true, "in_pascal": true})",
                 "Sitz;links\nkPa\n1,5;2;3;4\n5;6;7;8,25\n");
    CHECK(seat == std::vector<float>{5, 6, 7, 8.25F, 1.5F, 2, 3, 4});
    // A finger rotated on its board, with a time stamp in microseconds and dead cells of -1.
    const auto finger =
        decode(text_stream(parse_sensor(
                   R"({"rows": 2, "columns": 3, "cell": "digits", "rotation": 90, "leading_fields": 1,
                                       "seconds_per_tick": 1e-6, "broken": [-1], "broken_above": 1000})")),
               bytes_of("2000000\t1\t2\t3\t4\t-1\t1001\n"));
    REQUIRE(finger.frames.size() == 1);
    CHECK(finger.frames[0].seconds == 2.0);
    CHECK(finger.frames[0].cells[0] == 4);
    CHECK(finger.frames[0].cells[5] == 3);
    CHECK(std::isnan(finger.frames[0].cells[2]));
    CHECK(std::isnan(finger.frames[0].cells[4]));
}
