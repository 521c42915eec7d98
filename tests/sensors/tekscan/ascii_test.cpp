#include "decoded.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/tekscan/ascii.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <support/allocations.hpp>
#include <support/files/data_folder.hpp>
#include <vector>

using sensors_test::bytes_of;
using sensors_test::decoded;
using tactnet::decode_status;
using tactnet::tekscan_ascii;

namespace {

decoded decode(std::string_view text) {
    return sensors_test::decode(tekscan_ascii(), bytes_of(text));
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

/// "byte N, line L" of where `needle` stands last.
std::string place(const std::string& text, std::string_view needle) {
    const std::size_t at = text.rfind(needle);
    REQUIRE(at != std::string::npos);
    const auto lines = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    return "byte " + std::to_string(at) + ", line " + std::to_string(lines + 1);
}

const std::string header = "DATA_TYPE MOVIE\nROWS 2\nCOLS 3\nSECONDS_PER_FRAME 0.1\n";
const std::string two_frames =
    "ASCII_DATA @@\n\nFrame 1, 0,, 1/2/2019 6:21:52.34PM,,,Raw Sum=,,9\nB,5,0\n1,2,1\n\n"
    "Frame 2, 0.1,, 1/2/2019 6:21:52.44PM,,,Raw Sum=,,303\nB,250,50\n1,2,0\n@@\n";
const std::string recording = header + "START_FRAME 1\nEND_FRAME 2\nUNITS raw\n" + two_frames;

/// A recording with one more line in its header.
decoded with_line(const std::string& line) {
    return decode(header + line + "\n" + two_frames);
}

const std::vector<float> first{0, 5, 0, 1, 2, 1}, second{0, 250, 50, 1, 2, 0};

void check_both(const decoded& found) {
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 2);
    CHECK(found.frames[0].cells == first);
    CHECK(found.frames[1].cells == second);
    CHECK(found.frames[0].number == 1);
    CHECK(found.frames[1].number == 2);
    CHECK(found.frames[0].seconds == 0.0);
    CHECK(found.frames[1].seconds.value_or(-1) == doctest::Approx(0.1));
    CHECK(found.description.mask == std::vector<std::uint8_t>{0, 1, 1, 1, 1, 1});
}

} // namespace

static_assert(tactnet::frame_decoder<tekscan_ascii>);

TEST_CASE("tekscan_ascii: a recording as version 6.10 writes it") {
    check_both(decode(recording));
    CHECK(decode(recording).description.frames == 2);
    CHECK(decode(recording).description.unit == tactnet::pressure_unit::raw);
}

TEST_CASE("tekscan_ascii: line ends, byte order mark, blank lines, closing mark") {
    check_both(decode(replaced(recording, "\n", "\r\n")));
    check_both(decode(replaced(recording, "\nB", "\r\nB"))); // both in one file
    check_both(decode("\xEF\xBB\xBF" + recording));
    check_both(decode("\xEF\xBB\xBF" + recording.substr(recording.find("ROWS"))));
    CHECK(decode(replaced(recording, "1,2,0", "\xEF\xBB\xBF" + std::string("1,2,0"))).frames.size() == 1);
    check_both(decode(replaced(recording, "\n\n", "\n")));
    check_both(decode(replaced(recording, "\n", "\n\n")));
    check_both(decode(replaced(recording, "\n\n", "\n,,,,,,,,\n")));
    check_both(decode(replaced(recording, "\n\n", "\n;;;\n \t \n")));
    check_both(decode(replaced(recording, "@@\n", "@@,,,,\n")));
    check_both(decode(replaced(recording, "0\n@@\n", "0\n")));
    check_both(decode(recording.substr(0, recording.size() - 1)));
    check_both(decode(recording + "\r\n\x1A"));
    check_both(decode(replaced(recording, "ASCII_DATA @@", " ASCII_DATA\t@@ ")));
}

TEST_CASE("tekscan_ascii: what spreadsheets add: trailing separators and quotes, in any line") {
    check_both(decode(replaced(recording, "\n", ",,,,\n")));
    check_both(decode(replaced(recording, "\n", ", , \r\n")));
    check_both(decode(replaced(replaced(recording, "\nB,", "\n\"B\",\""), ",0\n", "\",\"0\"\n")));
    check_both(decode(replaced(replaced(recording, "\nFrame", "\n\"Frame"), "PM,", "PM\",")));
    check_both(decode(replaced(recording, "UNITS raw", "\"UNITS raw\",,")));
    check_both(decode(replaced(recording, "ROWS 2", "ROWS,2,,,")));
    CHECK(with_line("ROW_SPACING,0.127,centimeters,,").description.row_spacing.value_or(0) ==
          doctest::Approx(1.27e-3));
}

TEST_CASE("tekscan_ascii: separators: commas, semicolons, tabs, spaces, with blanks around them") {
    for (const std::string separator : {",", ";", "\t", " ", "   ", ", ", " ,", "\t,\t", " ; "}) {
        CAPTURE(separator);
        std::string text = recording;
        for (const std::string row : {"B,5,0", "1,2,1", "B,250,50", "1,2,0"})
            text = replaced(text, "\n" + row + "\n", "\n" + replaced(row, ",", separator) + "\n");
        check_both(decode(text));
        check_both(decode(replaced(text, "0\n", "0,,,\n")));
    }
}

TEST_CASE("tekscan_ascii: cells: decimals and exponents, exact to the last bit") {
    const auto found =
        decode("ROWS 1\nCOLS 11\nASCII_DATA @@\n0.1,.5,7.,1e2,2.5E-3,16777216,123456.789012345678,b,"
               "4294967296,99999999999,340282346638528859811704183484516925440\n@@\n");
    REQUIRE_MESSAGE(found.frames.size() == 1, found.error);
    CHECK(found.frames[0].cells == std::vector<float>{0.1F, 0.5F, 7, 100, 0.0025F, 16777216, 123456.789F, 0,
                                                      4294967296.F, 99999999999.F,
                                                      std::numeric_limits<float>::max()});
    CHECK(found.description.missing_cells() == 1);
    for (const std::string cell : {"1e39", "1e999"})
        CHECK(decode("ROWS 1\nCOLS 1\nASCII_DATA @@\n" + cell + "\n@@\n").error ==
              "byte 28, line 4, frame 1: expected a number that fits in column 1 of 1, found '" + cell + "'");
    CHECK(decode("ROWS 1\nCOLS 1\nUNITS MPa\nASCII_DATA @@\n1e33\n@@\n").status == decode_status::damaged);
}

TEST_CASE("tekscan_ascii: units: cells in pascal whatever they are written in, raw counts as they are") {
    const auto cell = [](const std::string& unit, const std::string& text = "12.3") {
        const auto found = decode("ROWS 1\nCOLS 1\nUNITS " + unit +
                                  "\nASCII_DATA @@\nFrame 1,0,,,,Raw Sum=,,99\n" + text + "\n@@\n");
        REQUIRE_MESSAGE(found.frames.size() == 1, found.error);
        CHECK((found.description.unit == tactnet::pressure_unit::pascal));
        return found.frames[0].cells[0];
    };
    CHECK(cell("KPa") == 12300);
    CHECK(cell("kPa ") == 12300);
    CHECK(cell("kPa", "12") == 12000);
    CHECK(cell("MPa") == 12.3e6F);
    CHECK(cell("Pa") == 12.3F);
    CHECK(cell("PSI") == static_cast<float>(12.3 * 6894.757293168361));
    CHECK(cell("psi,,,") == static_cast<float>(12.3 * 6894.757293168361));
    CHECK(cell("mmHg") == static_cast<float>(12.3 * 133.322387415));
    CHECK(cell("N/cm2") == 123000);
    CHECK((with_line("UNITS Raw ").description.unit == tactnet::pressure_unit::raw));
    CHECK(with_line("UNITS bananas").error == "byte 52, line 5: expected raw or a unit of pressure such "
                                              "as kPa, MPa, PSI, bar, mmHg, N/cm2 or kg/cm2, "
                                              "found 'UNITS' 'bananas'");
}

TEST_CASE("tekscan_ascii: header: lengths, areas, pressures and times in every unit") {
    const auto row = [](const std::string& length) {
        return with_line("ROW_SPACING " + length).description.row_spacing.value_or(-1);
    };
    for (const std::string length :
         {"1.27 mm", "1.27 millimeters", "0.127 centimeters", "0.127 cm", "0.05 inches", "0.05 in",
          "1.27 MM ", "1.27mm", "0.00127 meters", "1.27e-3 m", "1.27 (mm)", "1.27\tmm"}) {
        CAPTURE(length);
        CHECK(row(length) == doctest::Approx(1.27e-3).epsilon(1e-12));
    }
    const auto area = [](const std::string& value) {
        return with_line("SENSEL_AREA " + value).description.cell_area.value_or(-1);
    };
    for (const std::string value : {"1.6129 mm2", "0.016129 cm2", "0.0025 in2", "1.6129e-06 m2"}) {
        CAPTURE(value);
        CHECK(area(value) == doctest::Approx(1.6129e-6).epsilon(1e-12));
    }
    const auto saturation = [](const std::string& value) {
        return with_line("SATURATION_PRESSURE " + value).description.saturation_pressure.value_or(-1);
    };
    CHECK(saturation("1514.73 KPa ") == doctest::Approx(1514730));
    CHECK(saturation("1.51473 MPa") == doctest::Approx(1514730));
    CHECK(saturation("219.693 PSI") == doctest::Approx(1514730).epsilon(1e-5));
    CHECK(with_line("COL_SPACING 5 mm").description.column_spacing.value_or(-1) == doctest::Approx(5e-3));
    CHECK(with_line("NOISE_THRESHOLD 3").description.noise_threshold == 3);
    for (const std::string value : {"0.01", "0.01 s", "0.01 seconds", "10 ms"})
        CHECK(decode("ROWS 1\nCOLS 1\nSECONDS_PER_FRAME " + value + "\nASCII_DATA @@\n1\n@@\n")
                  .description.seconds_per_frame.value_or(-1) == doctest::Approx(0.01));
    // Without a unit, or with an unknown one, it could be anything.
    for (const std::string length : {"1", "1 furlong", "unknown", ""}) {
        CHECK(!with_line("ROW_SPACING " + length).description.row_spacing);
        check_both(with_line("ROW_SPACING " + length));
    }
}

TEST_CASE("tekscan_ascii: header: other keys are kept as they stand") {
    const auto found =
        decode(header +
               "VERSION Tekscan Pressure Measurement System 6.10I\n"
               "CALIBRATION_POINT_1 75.0001 (Kgs) 4798 (Raw Sum) 240 (Number of Loaded Cells)\n"
               "TIME 10:26:16.001 a.m.\nSCALE_FACTOR 0.0123\nEXPONENT 1\nMICRO_SECOND 0\n"
               "VersaPogoFsx\nFILENAME C:\\caf\xE9, 1.fsx\n" +
               two_frames);
    check_both(found);
    CHECK(found.description.version == "Tekscan Pressure Measurement System 6.10I");
    const auto& lines = found.description.header;
    const auto value = [&](const std::string& key) {
        for (const auto& line : lines)
            if (line.first == key)
                return line.second;
        return std::string("none");
    };
    CHECK(value("CALIBRATION_POINT_1") == "75.0001 (Kgs) 4798 (Raw Sum) 240 (Number of Loaded Cells)");
    CHECK(value("TIME") == "10:26:16.001 a.m.");
    CHECK(value("SCALE_FACTOR") == "0.0123");
    CHECK(value("VersaPogoFsx").empty());
    CHECK(value("FILENAME") == "C:\\caf\xE9, 1.fsx");
}

TEST_CASE("tekscan_ascii: header: comments are free text on the next line") {
    for (const std::string comment :
         {"COMMENTS:\nROWS of tactels 7 to 9 are worn", "COMMENTS:,,,\nFrame 1 is bad,,", "COMMENTS: none",
          "COMMENTS:", "COMMENTS:\n", "COMMENTS:\nROWS 77", "COMMENT @@\n\tROWS 3\n\nUNITS KPa\n@@"}) {
        CAPTURE(comment);
        check_both(with_line(comment));
    }
    CHECK(with_line("COMMENTS:\nwalking, slowly").description.header.back().second == "walking, slowly");
    CHECK(with_line("COMMENTS:\nfirst line\nUNITS bananas").status == decode_status::damaged);
    const auto prose = with_line("COMMENTS:\nfirst line\nUNITS were wrong\nUNITS raw");
    check_both(prose);
    CHECK(prose.description.header[4].second == "first line\nUNITS were wrong");
    CHECK(with_line("COMMENT @@\n\tROWS 3\n\nUNITS KPa\n@@").description.header.back().second ==
          "ROWS 3\n\nUNITS KPa");
    CHECK(with_line("COMMENT @@\ntext\n@@\nUNITS two bananas").status == decode_status::damaged);
    // Free text may speak of what ends a header.
    check_both(with_line("COMMENTS:\nASCII_DATA by hand\nSENSOR_MAP was lost"));
    // What may be free text or a line of the header is never taken for the one where there is another.
    for (const std::string line : {"ROWS 77", "UNITS KPa", "END_FRAME 3"}) {
        CAPTURE(line);
        CHECK(decode("COMMENTS:\n" + line + "\n" + recording).error.find("expected one line '") !=
              std::string::npos);
    }
    check_both(decode("COMMENTS:\nROWS 2\n" + recording));
    // Without a comment the header goes on.
    CHECK((with_line("COMMENTS:\nUNITS KPa").description.unit == tactnet::pressure_unit::pascal));
}

TEST_CASE("tekscan_ascii: frame lines: numbers, times, sums") {
    const auto frames = [](const std::string& one, const std::string& two) {
        const auto found = decode("ROWS 1\nCOLS 2\nSECONDS_PER_FRAME 0.01\nASCII_DATA @@\n" + one +
                                  "\n1,2\n" + two + "\n3,4\n@@\n");
        CHECK_MESSAGE(found.status == decode_status::finished, found.error);
        REQUIRE(found.frames.size() == 2);
        return std::vector<double>{found.frames[0].seconds.value_or(-1),
                                   found.frames[1].seconds.value_or(-1)};
    };
    const std::vector<double> tenth{0, 0.01};
    CHECK(frames("Frame 1", "Frame 2") == tenth);
    CHECK(frames("Frame 8", "Frame 9") == tenth);
    CHECK(frames("Frame 1, 0,, 2.12.2019 18:21:52,,,Raw Sum=,,3",
                 "Frame 2, 0.01,, 2.12.2019,,,Raw Sum=,,7") == tenth);
    CHECK(frames("Frame 1 , 0.0 ms", "Frame 2 , 10.0 ms") == tenth);
    CHECK(frames("Frame 1, 0 ms,,,", "Frame 2, 10 msec") == tenth);
    CHECK(frames("Frame 1, 0, ms", "Frame 2, 10, ms") == tenth);
    CHECK(frames("Frame 1, 0 ms, 5", "Frame 2, 10 ms, 6") == tenth);
    CHECK(frames("Frame 1 0 ms", "Frame 2 10 ms") == tenth);
    CHECK(frames("Frame 1: 0 s", "Frame 2: 0.01 s") == tenth);
    CHECK(frames("Frame 1, 0 (ms)", "Frame 2, 10 (ms)") == tenth);
    CHECK(frames("\tFrame\t1\t0\t\t6:21PM", "Frame\t2\t0.01") == tenth);
    CHECK(frames("Frame 1; 0; ; 6:21", "Frame 2; 0.01") == tenth);
    CHECK(frames("Frame 1, -0.1,, 6:21", "Frame 2, 0.0") == std::vector<double>{-0.1, 0});
    CHECK(frames("Frame 1, -100 ms", "Frame 2, -90 ms") == std::vector<double>{-0.1, -0.09});
    CHECK(frames("Frame 1, -100", "Frame 2, -90")[1] == -0.09);
    CHECK(frames("Frame 1, -", "Frame 2, -x") == tenth);
    CHECK(frames("Frame 1, 10:26:16.001 a.m.", "Frame 2, 10:26:16.011 a.m.") == tenth);
    CHECK(frames("Frame 1, 0,,2019-12-02 6:21", "Frame 2, 0.01,,2019-12-02 6:21") == tenth);
    // Without a unit, SECONDS_PER_FRAME distinguishes milliseconds from seconds.
    CHECK(frames("Frame 1, 0", "Frame 2, 10") == tenth);
    CHECK(frames("Frame 1, 0", "Frame 2, 10.4")[1] == doctest::Approx(0.0104));
    CHECK(frames("Frame 1, 0", "Frame 2, 0.02")[1] == 0.02);
    CHECK(frames("Frame 1000, 0", "Frame 1001, 10") == tenth);
    CHECK(frames("Frame 5, 40", "Frame 6, 50") == std::vector<double>{0.04, 0.05});
    CHECK(frames("Frame 1, 10.0", "Frame 2, 10.01") == std::vector<double>{10, 10.01});
    // Sums.
    CHECK(frames("Frame 1, 0,,,,,Raw Sum=3", "Frame 2, 0.01,,,,,Raw Sum=,7.0") == tenth);
    CHECK(frames("Frame 1, 0,,,,,Raw Sum=,,-99", "Frame 2, 0.01") == tenth);
    CHECK(frames("Frame 1, 0,,,,,Raw Sum=,,3,,99", "Frame 2, 0.01,,,,,Raw Sum=7,,99") == tenth);
    CHECK(frames("Frame 1, 0,,,,,Raw Sum=,,", "Frame 2, 0.01,,,,,raw sum = 7") == tenth);
    const auto none = decode("ROWS 1\nCOLS 1\nASCII_DATA @@\nFrame 1\n1\n");
    REQUIRE(none.frames.size() == 1);
    CHECK(!none.frames[0].seconds);
}

TEST_CASE("tekscan_ascii: a sum or a time that cannot be read is a warning with its place") {
    const auto warnings = [](std::string_view from, std::string_view to) {
        const std::string text = replaced(recording, from, to);
        CAPTURE(to);
        const decoded found = decode(text);
        CHECK(found.status == decode_status::finished);
        CHECK(found.warning_count == found.warnings.size());
        return found.warnings;
    };
    CHECK(warnings("9", "9").empty());
    const std::vector<std::string> unread{
        place(recording, "Frame 2") +
        ", frame 2: expected a number after 'Raw Sum=', found none, so that the "
        "cells are not checked"};
    for (const std::string sum : {"u03", "nan", "-303", "303x", "", "inf"})
        CHECK(warnings("Raw Sum=,,303", "Raw Sum=,," + sum) == unread);
    for (const std::string name : {"Raw 5um=", "raw_sum=", "Sum", "=", "Sum\x01"})
        CHECK(warnings("Raw Sum=,,303", name + ",,303") ==
              std::vector<std::string>{place(recording, "Frame 2") +
                                       ", frame 2: expected 'Raw Sum=' before the last number, found other "
                                       "text, so that the cells are not checked"});
    CHECK(warnings(",Raw Sum=,,303", "") ==
          std::vector<std::string>{place(recording, "Frame 2") +
                                   ", frame 2: expected a 'Raw Sum' in all frames "
                                   "or in none, found none any more"});
    CHECK(warnings(",Raw Sum=,,9", "").size() == 1);
    CHECK(warnings("Frame 2, 0.1,,", "Frame 2, p.1,,").size() == 1);
    // What is allowed: no sum and no time in any frame, other letters, a sum at once after the sign.
    CHECK(warnings(",,,Raw Sum=", ",,,,").size() == 2); // of numbers that nothing names
    CHECK(decode(replaced(replaced(recording, ",Raw Sum=,,303", ""), ",Raw Sum=,,9", "")).warning_count == 0);
    CHECK(warnings("Raw Sum=,,", "RAW SUM=").empty());
    CHECK(warnings("Raw Sum=,,", "Raw Sum,").empty());
    CHECK(warnings(", 0.1,,", ", 100 ms,,").empty());
}

TEST_CASE("tekscan_ascii: a measure of the header that cannot be read is a warning, and is left empty") {
    using description = tactnet::recording_description;
    const auto check = [](const std::string& line, std::optional<double> description::*measure) {
        CAPTURE(line);
        const decoded found = with_line(line);
        CHECK(found.status == decode_status::finished);
        REQUIRE(found.warnings.size() == 1);
        CHECK(found.warnings[0].find(", line 5: expected a measure from ") != std::string::npos);
        CHECK(!(found.description.*measure));
    };
    for (const std::string value : {"", "nan", "inf", "-1 mm", "0 mm", "1e308 mm", "1", "1 cubit"}) {
        check("ROW_SPACING " + value, &description::row_spacing);
        check("COL_SPACING " + value, &description::column_spacing);
    }
    for (const std::string value : {"", "nan", "0 cm2", "1e308 cm2", "1 acre"})
        check("SENSEL_AREA " + value, &description::cell_area);
    for (const std::string value : {"", "nan", "0 kPa", "1e308 kPa", "1 whatever"})
        check("SATURATION_PRESSURE " + value, &description::saturation_pressure);
    for (const std::string value : {"", "-3", "nan", "1e308", "x"})
        check("NOISE_THRESHOLD " + value, &description::noise_threshold);
    for (const std::string value : {"", "nan", "-1", "0", "1e308", "0.1 parsecs"}) {
        const decoded found =
            decode(replaced(recording, "SECONDS_PER_FRAME 0.1", "SECONDS_PER_FRAME " + value));
        CAPTURE(value);
        CHECK(found.warning_count == 1);
        CHECK(!found.description.seconds_per_frame);
    }
    // What is allowed: a threshold of zero, what real arrays have.
    for (const std::string line : {"NOISE_THRESHOLD 0", "ROW_SPACING 0.1 mm", "SATURATION_PRESSURE 200 MPa"})
        CHECK(with_line(line).warning_count == 0);
}

TEST_CASE("tekscan_ascii: text in UTF-16 or without line feeds is named as such") {
    std::string wide = "\xFF\xFE";
    for (const char c : recording)
        wide += c, wide += '\0';
    CHECK(decode(wide).error ==
          "byte 0, line 1: expected lines of text in ASCII or UTF-8, found text in UTF-16: save it as UTF-8");
    CHECK(decode(wide.substr(2)).error.find("found text in UTF-16") != std::string::npos);
    CHECK(decode(replaced(recording, "\n", "\r")).error.find("found carriage returns without line feeds") !=
          std::string::npos);
    check_both(decode(replaced(recording, "\n", "\r\n")));
}

TEST_CASE("tekscan_ascii: one frame without a line of its own") {
    for (const std::string range : {"", "START_FRAME 1\nEND_FRAME 1\n", "START_FRAME 1\nEND_FRAME 99\n"})
        for (const std::string end : {"@@\n", ""}) {
            const auto found = decode("ROWS 2\nCOLS 2\n" + range + "ASCII_DATA @@\n\n1,B\n3,4\n" + end);
            CHECK_MESSAGE(found.status == decode_status::finished, found.error);
            REQUIRE(found.frames.size() == 1);
            CHECK(found.frames[0].cells == std::vector<float>{1, 0, 3, 4});
            CHECK(found.frames[0].number == 1);
        }
    CHECK(decode("ROWS 1\nCOLS 1\nASCII_DATA @@\n1\nFrame 2\n2\n@@\n")
              .error.find("expected the end after a frame without a line 'Frame', found 'Frame 2'") !=
          std::string::npos);
}

TEST_CASE("tekscan_ascii: what does not agree with the header is an error with its place") {
    // Changes the recording and expects the sentence, with the place where `needle` stands.
    const auto refuses = [](const std::string& from, const std::string& to, const std::string& needle,
                            const std::string& sentence) {
        const std::string text = replaced(recording, from, to);
        CHECK(decode(text).error == place(text, needle) + sentence);
    };
    const std::string both = " (2 announced frames are missing)", one = " (1 announced frames are missing)";
    refuses("1,2,1\n", "", "Frame 2",
            ", frame 1: expected 2 rows, found 1 before 'Frame 2, 0.1,, 1/2/2…'" + both);
    refuses("1,2,1\n", "1,2,1\n7,7,7\n", "7,7,7",
            ", frame 1: expected 2 rows in a frame, found one more" + both);
    refuses("1,2,1\n", "1,2\n", "\n\nFrame 2",
            ", frame 1: expected more cells in this row in column 3 of 3, found the end of the line" + both);
    refuses("1,2,1\n", "1,2,1,4\n", "4\n\nFrame 2",
            ", frame 1: expected the end of the row after 3 columns, found '4'" + both);
    refuses("END_FRAME 2", "END_FRAME 3", "@@", ", frame 3: expected 3 frames, found 2 before '@@'" + one);
    refuses("END_FRAME 2", "END_FRAME 1", "@@", ", frame 3: expected 1 frames, found 2 before '@@'");
    refuses("=,,303", "=,,304", "@@",
            ", frame 2: expected cells with a sum of 304 as the frame says, found 303" + one);
    refuses("B,250,50", "1,249,50", "@@",
            ", frame 2: expected tactels in the same cells as in the first frame, found a tactel in row 1, "
            "column 1" +
                one);
    refuses("0\n@@", "B\n@@", "@@",
            ", frame 2: expected tactels in the same cells as in the first frame, found none in row 2, "
            "column 3" +
                one);
    // A line that is neither row nor 'Frame' is not the end of a frame.
    refuses("Frame 2", "Fname 2", "Fname", ", frame 1: expected 2 rows in a frame, found one more" + both);
    CHECK(decode(replaced(recording, "Frame 2", "Frame 1"))
              .error.find("expected a frame after number 1, found number 1") != std::string::npos);
    CHECK(decode(recording + "1,2,3\n").error.find("expected nothing after the closing @@, found '1,2,3'") !=
          std::string::npos);
    CHECK(decode(recording + "more\n").status == decode_status::damaged);
    // The frames before are whole.
    CHECK(decode(replaced(recording, "=,,303", "=,,304")).frames.size() == 1);
    CHECK(decode(replaced(recording, "=,,9", "=,,8")).frames.empty());
}

TEST_CASE("tekscan_ascii: cells that are no counts and no pressures") {
    for (const std::string cell :
         {"-1", "+1", "x", "nan", "inf", "1e99", "0x10", "1.2.3", "", "BB", "1 2", "1:2", "1e"}) {
        CAPTURE(cell);
        const auto found = decode(replaced(recording, "B,250,50", "B," + cell + ",50"));
        CHECK(found.status == decode_status::damaged);
        CHECK(found.frames.size() == 1);
        CHECK(found.error.find("frame 2") != std::string::npos);
    }
}

TEST_CASE("tekscan_ascii: sums of cells with decimals, which are rounded") {
    const auto status = [](const std::string& sum, const std::string& end) {
        return decode("ROWS 1\nCOLS 2\nASCII_DATA @@\nFrame 1,0,,,,Raw Sum=,," + sum + "\n12.5,0.3" + end)
            .status;
    };
    CHECK(status("12.8", "\n@@\n") == decode_status::finished);
    CHECK(status("13", "\n@@\n") == decode_status::finished);
    CHECK(status("14", "\n@@\n") == decode_status::damaged);
    CHECK(status("12", "\n@@\n") == decode_status::damaged);
    tekscan_ascii decoder;
    decoder.push(bytes_of("ROWS 1\nCOLS 1\nASCII_DATA @@\nFrame 1,0,,,,Raw Sum=,,7\n7\nFrame 2\n7\n@@\n"),
                 tactnet::ignore_frames{});
    CHECK(decoder.frames() == 2);
    CHECK(decoder.matching_sums() == 1);
    // Each of ten pressed cells may be off by half a tenth; those of zero are not.
    const auto ten = [](const std::string& sum) {
        return decode("ROWS 1\nCOLS 20\nASCII_DATA @@\nFrame 1,0,,,,Raw Sum=,," + sum +
                      "\n1.5 1.5 1.5 1.5 1.5 1.5 1.5 1.5 1.5 1.5 0 0 0 0 0 0 0 0 0 0\n@@\n")
            .status;
    };
    CHECK(ten("16") == decode_status::finished);
    CHECK(ten("14") == decode_status::finished);
    CHECK(ten("16.1") == decode_status::damaged);
    CHECK(ten("13.9") == decode_status::damaged);
    // The last number may be cut: then only the very sum will do.
    CHECK(status("12.8", "") == decode_status::damaged);
    CHECK(status("13", "") == decode_status::damaged);
}

TEST_CASE("tekscan_ascii: a decimal comma is never read as anything else") {
    const std::string start = "ROWS 1\nCOLS 2\nASCII_DATA @@\n";
    for (const std::string row : {"1,5\t2,5", "1,5 2,5", "1,5;2,5", "0\t1,5", "0;1,5", "1,5\t2"}) {
        CAPTURE(row);
        const auto found = decode(start + row + "\n@@\n");
        CHECK(found.status == decode_status::damaged);
        CHECK(found.frames.empty());
    }
    // Not even where it makes as many cells as there should be.
    for (const std::string row : {"1,5\t2", "1 2,5", "1,5;2", "1;2,5"}) {
        CAPTURE(row);
        CHECK(decode("ROWS 1\nCOLS 3\nASCII_DATA @@\n" + row + "\n@@\n")
                  .error.find("expected one kind of separator in a row") != std::string::npos);
    }
    CHECK(with_line("ROW_SPACING 1,27 mm").status == decode_status::damaged);
    CHECK(with_line("SATURATION_PRESSURE 1,514.73 KPa").status == decode_status::damaged);
    CHECK(with_line("NOISE_THRESHOLD 0,5").status == decode_status::damaged);
    CHECK(decode("ROWS 1\nCOLS 1\nASCII_DATA @@\nFrame 1, 0,1,, 2.12.2019\n1\n@@\n").status ==
          decode_status::damaged);
}

TEST_CASE("tekscan_ascii: headers that make no sense") {
    const auto error = [](const std::string& text) { return decode(text + "ASCII_DATA @@\n1\n@@\n").error; };
    CHECK(error("COLS 1\n") == "byte 7, line 2: expected a line 'ROWS' in the header, found none");
    CHECK(error("ROWS 1\n") == "byte 7, line 2: expected a line 'COLS' in the header, found none");
    for (const std::string rows : {"0", "-1", "x", "1.5", "1048577", "99999999999999999999", ""}) {
        CAPTURE(rows);
        CHECK(error("ROWS " + rows + "\nCOLS 1\n")
                  .find("expected a number of rows or columns from 1 to 1048576") != std::string::npos);
    }
    CHECK(error("ROWS 1025\nCOLS 1024\n") ==
          "byte 20, line 3: expected at most 1048576 cells, found 1025 x 1024");
    CHECK(error("ROWS 1\nROWS 2\nCOLS 1\n") == "byte 7, line 2: expected one line 'ROWS', found '1' and '2'");
    CHECK(error("ROWS 1\nCOLS 1\nROWS 1\n").empty());
    for (const std::string range : {"5\nEND_FRAME 4\n", "0\nEND_FRAME 18446744073709551615\n"})
        CHECK(error("ROWS 1\nCOLS 1\nSTART_FRAME " + range).find("expected an END_FRAME not before") !=
              std::string::npos);
    for (const std::string line : {"START_FRAME one\n", "END_FRAME 2x\n", "START_FRAME -1\n"})
        CHECK(error("ROWS 1\nCOLS 1\n" + line).find("expected the number of a frame") != std::string::npos);
    CHECK(decode("ROWS 1\nCOLS 1\n").error ==
          "byte 13, line 2: expected a header that ends with 'ASCII_DATA @@', found the end of the data");
    CHECK(decode("").status == decode_status::damaged);
    CHECK(decode("ROWS 1\nCOLS 1\nASCII_DATA @@\n").error ==
          "byte 27, line 3, frame 1: expected 1 frames, found 0 before the end of the data");
    CHECK(decode("ROWS 1\nCOLS 1\nSENSOR_MAP @@\n1\n@@\n").status == decode_status::damaged);
}

TEST_CASE("tekscan_ascii: split anywhere, the same comes out") {
    CHECK(sensors_test::same_however_split(tekscan_ascii(), bytes_of(recording)));
    CHECK(sensors_test::same_however_split(tekscan_ascii(), bytes_of(replaced(recording, "\n", ",,\r\n"))));
    CHECK(sensors_test::same_however_split(tekscan_ascii(), bytes_of("\xEF\xBB\xBF" + recording)));
    CHECK(sensors_test::same_however_split(tekscan_ascii(), bytes_of(replaced(recording, "=,,303", "=,,1"))));
}

TEST_CASE("tekscan_ascii: cut short anywhere, whole frames come out and no others") {
    CHECK(sensors_test::only_whole_frames_when_cut(tekscan_ascii(), bytes_of(recording)));
    // Without sums, cells that are cut are recognised by the missing line end.
    const std::string bare = "ROWS 1\nCOLS 2\nSTART_FRAME 1\nEND_FRAME 2\nUNITS KPa\nASCII_DATA "
                             "@@\nFrame 1\n1,222\nFrame 2\n3.125,4.75\n";
    CHECK(decode(bare).status == decode_status::finished);
    CHECK(sensors_test::only_whole_frames_when_cut(tekscan_ascii(), bytes_of(bare)));
    CHECK(decode(bare.substr(0, bare.size() - 1)).error ==
          "byte " + std::to_string(bare.size() - 1) +
              ", line 10, frame 2: expected a line end after the last number, which may be cut, found "
              "the end of the data "
              "(1 announced frames are missing)");
    CHECK(decode(recording.substr(0, recording.find("B,250"))).error ==
          "byte " + std::to_string(recording.find("B,250") - 1) +
              ", line 14, frame 2: expected 2 rows, found 0 before the end of the data "
              "(1 announced frames are missing)");
    // What was begun after a whole frame does not take it away.
    CHECK(decode(recording.substr(0, recording.find("me 2"))).frames.size() == 1);
    CHECK(decode(recording.substr(0, recording.size() - 2)).frames.size() == 2);
}

TEST_CASE("tekscan_ascii: memory does not grow with the stream, nor with what a header announces") {
    tekscan_ascii decoder;
    decoder.push(bytes_of("ROWS 4\nCOLS 4\nASCII_DATA @@\n"), tactnet::ignore_frames{});
    const std::string rows = "1,2,3,4\n1,2,3,4\n1,2,3,4\n1,2,3,4\n";
    const auto push = [&](std::size_t number) {
        return decoder.push(bytes_of("Frame " + std::to_string(number) + "\n" + rows),
                            tactnet::ignore_frames{});
    };
    for (std::size_t i = 1; i < 4; ++i)
        push(i);
    const std::string frame = "Frame 1000000\n" + rows;
    const std::size_t before = support::bytes_allocated();
    decoder.push(bytes_of(frame), tactnet::ignore_frames{});
    CHECK(support::bytes_allocated() == before);
    CHECK(decoder.frames() == 3);

    const std::size_t start = support::bytes_allocated();
    CHECK(decode("ROWS 1024\nCOLS 1024\nASCII_DATA @@\n1,2\n")
              .error.find("expected more cells in this row in column 3 of 1024") != std::string::npos);
    CHECK(support::bytes_allocated() - start < 100'000);

    const auto with_header_of = [](std::size_t bytes) {
        const std::string begin = "ROWS 1\nCOLS 1\nKEY ", end = "\nASCII_DATA @@\n";
        return decode(begin + std::string(bytes - begin.size() - end.size(), 'x') + end + "1\n@@\n").status;
    };
    CHECK(with_header_of(tactnet::largest_header_bytes) == decode_status::finished);
    CHECK(with_header_of(tactnet::largest_header_bytes + 1) == decode_status::damaged);

    const std::string line(tactnet::largest_header_bytes + 1, 'x');
    CHECK(decode(line).error ==
          "byte 0, line 1: expected a line of at most 262144 bytes, found a longer one");
    CHECK(decode(line.substr(1)).error.find("expected a header of at most") != std::string::npos);
    const std::string sentence =
        "expected a header of at most 262144 bytes and 8192 lines, found a longer one";
    for (const std::string& each :
         {"KEY " + std::string(1000, 'x') + "\n", std::string("K\n"), std::string("\n")}) {
        std::string lines;
        for (std::size_t i = 0; i <= tactnet::largest_header_lines; ++i)
            lines += each;
        CHECK(decode(lines).error.find(sentence) != std::string::npos);
    }
}

TEST_CASE("tekscan_ascii: in the real recording every frame has the sum that it declares" *
          doctest::test_suite("data")) {
    const auto path = support::find_data("tekscan/iscan_test.csv");
    if (!path)
        return;
    const auto bytes = tactnet::read_file(*path);
    tekscan_ascii decoder;
    std::size_t frames = 0;
    decoder.push(bytes, [&](const tactnet::frame_view& frame) {
        ++frames;
        CHECK(frame.number == frames);
        CHECK(frame.seconds.has_value());
    });
    CHECK(decoder.finish(tactnet::ignore_frames{}) == decode_status::finished);
    CHECK(decoder.frames() == 309);
    CHECK(decoder.matching_sums() == 309);
    CHECK(decoder.description().missing_cells() == 300);
    CHECK(decoder.description().row_spacing.value_or(0) == doctest::Approx(1.27e-3));
    CHECK(decoder.description().cell_area.value_or(0) == doctest::Approx(1.6129e-6));
    const auto whole = sensors_test::decode(tekscan_ascii(), bytes);
    CHECK(whole.frames[0].cells[2 * 28 + 2] == 5);
    CHECK(whole.frames[0].cells[18 * 28 + 20] == 22);
    std::vector<std::size_t> every(bytes.size());
    for (std::size_t i = 0; i < every.size(); ++i)
        every[i] = i;
    CHECK(sensors_test::decode(tekscan_ascii(), bytes, every).frames == whole.frames);
    CHECK(sensors_test::only_whole_frames_when_cut(tekscan_ascii(), bytes, 9973));
    // One cell changed, one row lost, one row twice: each is seen.
    for (const std::size_t at : {100'000UL, 250'001UL, 400'002UL}) {
        const auto line =
            std::find(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), std::byte{'\n'}) + 1;
        const auto next = std::find(line, bytes.end(), std::byte{'\n'}) + 1;
        auto lost = bytes, twice = bytes;
        lost.erase(lost.begin() + (line - bytes.begin()), lost.begin() + (next - bytes.begin()));
        twice.insert(twice.begin() + (line - bytes.begin()), line, next);
        CHECK(sensors_test::decode(tekscan_ascii(), lost).status == decode_status::damaged);
        CHECK(sensors_test::decode(tekscan_ascii(), twice).status == decode_status::damaged);
    }
}
