#include "decoded.hpp"

#include <tactnet/sensors/any_recording.hpp>
#include <tactnet/sensors/described/text_stream.hpp>
#include <tactnet/sensors/novel.hpp>
#include <tactnet/sensors/recording.hpp>
#include <tactnet/sensors/tekscan/equilibration.hpp>
#include <tactnet/sensors/xsensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <support/files/data_folder.hpp>
#include <vector>

using sensors_test::bytes_of, sensors_test::decode, sensors_test::same_however_split;
using tactnet::decode_status, tactnet::novel_ascii, tactnet::xsensor_csv;
using namespace std::string_literals;

namespace {

const std::string novel =
    "file name: a.mat\nmat type s\ntotal times [secs]: 2 time per frame [secs]: 0.5 rate\n"
    "pressure values in kPa\n\ntime[secs] 4 5 8 9\n0.5 1.5 2 3 0\n1.0\t5\t6\t7\t8\n";
const std::string xsensor =
    "\xEF\xBB\xBF"
    "File:,\"a\",,\r\n,,,\r\nUnits:,kPa,,\r\nFRAME,7,,\r\nTime, "
    "08:00:01.5,,\r\nSENSOR,L,,\r\nRows,2,,\r\nColumns,2,,\r\n"
    "Sensel Width "
    "(cm),0.5,,\r\nSENSELS,,,\r\n1,2,,\r\n,,,\r\n3,4,,\r\nSENSOR,R,,\r\nRows,2,,\r\nColumns,2,,\r\n"
    "SENSELS,,,\r\n5,6,,\r\n7,8,,\r\nGROUP,1,,\r\nSENSELS,,,\r\n9,9,9,\r\n"
    "FRAME,8,,\r\nTime, "
    "08:00:02.5,,\r\nSENSOR,L,,\r\nRows,2,,\r\nColumns,2,,\r\nSENSELS,,,\r\n0,0,,\r\n0,0,,\r\n"
    "SENSOR,R,,\r\nRows,2,,\r\nColumns,2,,\r\nSENSELS,,,\r\n0,0,,\r\n0,1,,\r\n";

} // namespace

TEST_CASE("novel_ascii: rows by runs of numbers, times, pascal; damage") {
    const auto found = decode(novel_ascii(), bytes_of(novel));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 2);
    CHECK(found.description.rows == 2);
    CHECK(found.description.columns == 2);
    CHECK(found.description.seconds_per_frame == 0.5);
    CHECK(found.description.unit == tactnet::pressure_unit::pascal);
    CHECK(found.frames[0].cells == std::vector<float>{1500, 2000, 3000, 0});
    CHECK(found.frames[1].seconds == 1.0);
    CHECK(same_however_split(novel_ascii(), bytes_of(novel)));
    CHECK(decode(novel_ascii(), bytes_of(novel + "1.5 1 2 3\n")).error ==
          "byte 151, line 9, frame 3: expected 4 pressures, found 3 and then ''");
    CHECK(decode(novel_ascii(), bytes_of("file name: a\n")).error.find("expected a line 'time[secs] …'") !=
          std::string::npos);
}

TEST_CASE("xsensor_csv: sensors side by side, groups left out; damage") {
    const auto found = decode(xsensor_csv(), bytes_of(xsensor));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 2);
    CHECK(found.description.rows == 2);
    CHECK(found.description.columns == 4);
    CHECK(found.description.column_spacing == doctest::Approx(0.005));
    CHECK(found.frames[0].number == 7);
    CHECK(found.frames[0].cells == std::vector<float>{1000, 2000, 5000, 6000, 3000, 4000, 7000, 8000});
    CHECK(found.frames[1].seconds == 1.0);
    CHECK(same_however_split(xsensor_csv(), bytes_of(xsensor)));
    const std::size_t row = xsensor.find("\r\n3,4");
    CHECK(decode(xsensor_csv(), bytes_of(xsensor.substr(0, row) + xsensor.substr(row + 7)))
              .error.find("expected 2 rows of a sensor, found 1") != std::string::npos);
}

TEST_CASE("other_arrays: recorded files of XSENSOR, novel and Tekscan" * doctest::test_suite("data")) {
    const auto folder = support::find_data("other_arrays");
    if (!folder)
        return;
    const auto whole = [&](const char* name, auto decoder, std::size_t rows, std::size_t columns,
                           std::size_t frames) {
        const auto read = tactnet::decode_all(std::move(decoder), tactnet::read_file(*folder / name));
        CHECK_MESSAGE(!read.damage, name << ": " << read.damage->message());
        CHECK(read.description.rows == rows);
        CHECK(read.description.columns == columns);
        CHECK(read.size() == frames);
        return read;
    };
    const auto insoles = whole("xsensor_insoles.csv", tactnet::any_recording(), 31, 22, 12);
    CHECK(insoles[0].number == 1464);
    const auto first = insoles[0].cells; // with the peak that the file states
    CHECK(*std::max_element(first.begin(), first.end()) == doctest::Approx(2674.44 * 133.322387415));
    const auto pedar = whole("novel_pedar.asc", novel_ascii(), 2, 99, 190);
    CHECK(pedar[0](0, 0) == 32500);
    whole("novel_pliance.asc", tactnet::any_recording(), 28, 29, 142);
    const auto even = tactnet::read_equilibration(*folder / "tekscan_equilibration.equ");
    const auto taken = tactnet::decode_all(tactnet::any_recording(),
                                           tactnet::read_file(*folder / "tekscan_equilibration.equ"));
    REQUIRE(taken.damage);
    CHECK(taken.damage->found == "an equilibration: see read_equilibration");
    const auto gains = even.gains();
    REQUIRE(gains.size() == 44 * 52);
    // The third table of the file is the mean, 27284, of the second, 38000 in the first cell.
    CHECK(gains[0] == doctest::Approx(27284.0 / 38000).epsilon(1e-4));
}

TEST_CASE("other_arrays: the text recordings of a pressure mat by a description") {
    // A line of the mat: 64 x 32 numbers, tabs, a trailing tab, CRLF; counts above 1000 are glitches.
    std::string text;
    for (int frame = 0; frame < 3; ++frame) {
        for (int cell = 0; cell < 2048; ++cell)
            text += std::to_string(cell == 7 ? 1100 : (frame + cell) % 1000) + "\t";
        text += "\r\n";
    }
    const tactnet::sensor_description mat{.rows = 64,
                                          .columns = 32,
                                          .cell = tactnet::cell_type::digits,
                                          .full_scale = 1000,
                                          .broken_above = 1000};
    const auto found = decode(tactnet::text_stream(mat), bytes_of(text));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 3);
    CHECK(found.frames[1].cells[2047] == 48);
    CHECK(std::isnan(found.frames[1].cells[7]));
}
