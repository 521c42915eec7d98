#include "../decoded.hpp"

#include <tactnet/sensors/any_recording.hpp>
#include <tactnet/sensors/described/npy.hpp>
#include <tactnet/sensors/described/pgm.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

using sensors_test::bytes_of, sensors_test::decode, sensors_test::same_however_split,
    sensors_test::only_whole_frames_when_cut;
using tactnet::any_recording, tactnet::npy_array, tactnet::pgm_images;
using namespace std::string_literals;

namespace {

/// As numpy.save writes it, without the blanks that align the data.
std::string npy(const std::string& type, const std::string& shape, const std::string& cells,
                const std::string& by_columns = "False", char version = 1) {
    const std::string said =
        "{'descr': " + type + ", 'fortran_order': " + by_columns + ", 'shape': (" + shape + "), }\n";
    return "\x93NUMPY"s + version + '\0' + static_cast<char>(said.size()) +
           std::string(version == 1 ? 1 : 3, '\0') + said + cells;
}
std::string doubles(const std::vector<double>& values) {
    std::string bytes;
    for (const double value : values)
        for (unsigned byte = 0; byte < 8; ++byte)
            bytes += static_cast<char>(std::bit_cast<std::uint64_t>(value) >> (8 * byte));
    return bytes;
}

} // namespace

TEST_CASE("npy_array: types, byte orders, frames, versions") {
    for (const auto& [bytes, frames] : std::vector<std::pair<std::string, std::vector<std::vector<float>>>>{
             {npy("'|u1'", "1, 3", "\1\2\3"), {{1, 2, 3}}},
             {npy("'|b1'", "2, 1", "\0\1"s), {{0, 1}}},
             {npy("'<u2'", "2, 1, 2", "\1\0\2\0\3\0\4\1"s), {{1, 2}, {3, 260}}},
             {npy("'|u1'", "1, 1", "\xC8"), {{200}}},
             {npy("'|i1'", "1, 2", "\x7F\0"s), {{127, 0}}},
             {npy("'<u2'", "1, 2", "\0\x80\xFF\xFF"s), {{32768, 65535}}},
             {npy("'<u4'", "1, 1", "\0\0\0\x80"s), {{2147483648.0F}}},
             {npy("'<i4'", "1, 1", "\0\0\0\x7F"s), {{2130706432}}},
             {npy("'<u8'", "1, 1", "\0\0\0\0\0\0\0\x80"s), {{9223372036854775808.0F}}},
             {npy("'>i2'", "1, 2", "\1\2\x7F\xFF"), {{258, 32767}}},
             {npy("'<i8'", "1, 1", "\1\1\0\0\0\0\0\0"s), {{257}}},
             {npy("'>i8'", "1, 1", "\0\0\0\0\0\0\1\1"s), {{257}}},
             {npy("'>f4'", "1, 1", "\x3F\xC0\0\0"s), {{1.5F}}},
             {npy("'<f8'", "1,2,2", doubles({0.5, 1, 2, 3}), "False", 2), {{0.5F, 1, 2, 3}}},
             {npy("'<f8'", "2, 2", doubles({1, 2, 3, 4}), "True", 3), {{1, 3, 2, 4}}},
             {npy("'|u1'", "1, 1", "\7") + npy("'|u1'", "1, 1", "\x8"), {{7}, {8}}}}) {
        const auto found = decode(npy_array(), bytes_of(bytes));
        CHECK_MESSAGE(found.error.empty(), found.error);
        REQUIRE(found.frames.size() == frames.size());
        for (std::size_t i = 0; i < frames.size(); ++i)
            CHECK(found.frames[i].cells == frames[i]);
        CHECK(same_however_split(npy_array(), bytes_of(bytes)));
        if (bytes.rfind(npy_array::magic) == 0) // of several arrays, the first is whole without the others
            CHECK(only_whole_frames_when_cut(npy_array(), bytes_of(bytes)));
        CHECK(decode(any_recording(), bytes_of(bytes)).frames == found.frames);
    }
}

TEST_CASE("npy_array: what is wrong in it and in pgm_images is said with its place") {
    for (const auto& [bytes, error] : std::vector<std::pair<std::string, const char*>>{
             {"\x93NUMPX\1\0\1\0\0\0"s, R"(byte 0: expected '\x93NUMPY', found '\x93NUMPX')"},
             {"\x93NUMPY\4\0\1\0\0\0"s, "expected version 1 to 3 and a head of less than 262144 bytes"},
             {npy("[('a', '<f4')]", "1, 1", ""),
              "expected integers, booleans, or floats of 32 or 64 bits, found '["},
             {npy("'<c8'", "1, 1", ""), "or floats of 32 or 64 bits, found ''<c8', "},
             {npy("'<f4'", "3,", ""),
              "expected rows x columns, or frames x rows x columns, in the order of C"},
             {npy("'<f4'", "2, 1, 1", "", "True"), "in the order of C, found "},
             {npy("'<f4'", "0, 1", ""), "expected rows: 1 to 1048576, found 0"},
             {npy("'<f4'", "-1, 3, 4", ""), "expected rows x columns, or frames x rows x columns"},
             {npy("'<f4'", "18446744073709551616, 3, 4", ""), "frames x rows x columns, in the order"},
             {npy("'<f4'", "1, 1", "", "maybe"), "frames x rows x columns, in the order of C, found"},
             {npy("'|i1'", "1, 2", "\x7F\x80"),
              "cells of zero or more, found another value in row 1, column 2"},
             {npy("'<i4'", "1, 1", "\0\0\0\x80"s),
              "cells of zero or more, found another value in row 1, column 1"},
             {npy("'>i2'", "2, 1", "\xFF\xFF\1\2"),
              "cells of zero or more, found another value in row 1, column 1"},
             {npy("'<i8'", "1, 1", "\0\0\0\0\0\0\0\x80"s),
              "cells of zero or more, found another value in row 1"},
             {npy("'<f4'", "2, 1, 1", "\0\0\x80\xBF"s),
              "frame 1: expected cells of zero or more, found another "
              "value in row 1, column 1 (2 announced frames"},
             {npy("'|u1'", "2, 1, 3", "\1\2\3\4"),
              "frame 2: expected 3 bytes of a frame, found 1 of them (1 announced"},
             {npy("'|u1'", "1, 1", "\7") + npy("'|u1'", "1, 2", "\x8\x8"),
              "expected 1 x 1 cells, found 1 x 2"},
             {npy("'|u1'", "1, 1", "\7") + "junk",
              "frame 2: expected a whole head, found the end of the data"}}) {
        const std::string found = decode(npy_array(), bytes_of(bytes)).error;
        CHECK_MESSAGE(found.find(error) != std::string::npos, found);
    }
    for (const auto& [bytes, error] : std::vector<std::pair<std::string, const char*>>{
             {"P2 1 1 9\n3", "byte 0: expected 'P5', binary grey values, found 'P2'"},
             {"P5 1 x", "expected columns, rows and the largest value, found 'x'"},
             {"P5 1 1 65536 ", "expected a largest value from 1 to 65535, found '65536'"},
             {"P5 2 1 255\n\1", "frame 1: expected 2 bytes of a frame, found 1 of them"},
             {"P5 1 1 255\n\1P5 2 1 255\n\1\2", "frame 2: expected 1 x 1 cells, found 1 x 2"},
             {"P5 1 2 200\n\xC8\xC9", "expected cells of at most 200, found 201 in row 2, column 1"},
             {"P5 2 1 999\n\3\xE7\3\xE8", "expected cells of at most 999, found 1000 in row 1, column 2"},
             {"P5 1 0 255\n", "expected rows: 1 to 1048576, found 0"},
             {"P5 1 1", "expected a whole head, found the end of the data"}}) {
        const std::string found = decode(pgm_images(), bytes_of(bytes)).error;
        CHECK_MESSAGE(found.find(error) != std::string::npos, found);
    }
}

TEST_CASE("pgm_images: bytes, 16 bits, comments, several images; counts as a description says") {
    const std::string bytes = "P5#a\n# b\n2 1 # c\n200\n\1\2P5 2 1 200\n\3\4",
                      deep = "P5\n2 1\n4095\n\1\2\xF\xFF";
    const auto found = decode(pgm_images(), bytes_of(bytes));
    CHECK_MESSAGE(found.error.empty(), found.error);
    REQUIRE(found.frames.size() == 2);
    CHECK(found.frames[1].cells == std::vector<float>{3, 4});
    CHECK(found.description.full_scale == 200);
    CHECK(same_however_split(pgm_images(), bytes_of(bytes)));
    CHECK(decode(any_recording(), bytes_of(deep)).frames[0].cells == std::vector<float>{258, 4095});
    // The description of a device: its framing and rows do not matter to a file, its counts do.
    const tactnet::sensor_description sensor{.rows = 1,
                                             .columns = 2,
                                             .flipped_columns = true,
                                             .marker = {std::byte{'A'}},
                                             .seconds_per_frame = 0.5,
                                             .offset = 300,
                                             .inverted = true,
                                             .broken = {4095}};
    for (const std::string& file : {deep, npy("'>u2'", "1, 2", "\1\2\xF\xFF")}) {
        const auto counts = decode(any_recording(sensor), bytes_of(file));
        REQUIRE(counts.frames.size() == 1);
        CHECK(std::isnan(counts.frames[0].cells[0]));
        CHECK(counts.frames[0].cells[1] == 42);
        CHECK(counts.frames[0].seconds == 0);
    }
    // Otherwise bytes are the packets or lines that it describes.
    tactnet::sensor_description lines{.rows = 1, .columns = 2, .cell = tactnet::cell_type::digits};
    CHECK(decode(any_recording(lines), bytes_of("5,6\n7,8\n")).frames.size() == 2);
    CHECK(decode(any_recording(tactnet::sensor_description{.rows = 1, .columns = 2}), bytes_of("\5\6\7\x8"))
              .frames.size() == 2);
    lines.rows = 0;
    CHECK_THROWS_AS(any_recording{lines}, std::invalid_argument);
    CHECK(decode(npy_array({.rows = 3, .columns = 3}), bytes_of(npy("'|u1'", "1, 1", "\7")))
              .error.find("expected 3 x 3 cells, found 1 x 1") != std::string::npos);
}
