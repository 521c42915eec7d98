#include <tactnet/sensors/text/lines.hpp>
#include <tactnet/sensors/text/measures.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace tactnet;
using tactnet::scan_number;

std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

struct taken_line {
    std::string text;
    std::size_t byte, number;
    bool ended;
    friend bool operator==(const taken_line&, const taken_line&) = default;
};
/// The lines of a text that comes in pieces of so many bytes.
std::vector<taken_line> lines_of(std::string_view text, std::size_t piece) {
    line_splitter splitter;
    std::vector<taken_line> lines;
    const auto take = [&](const text_line& line) {
        lines.push_back({std::string(line.text), line.byte, line.number, line.ended});
        return true;
    };
    for (std::size_t at = 0; at < text.size(); at += piece)
        CHECK(splitter.push(bytes_of(text.substr(at, piece)), take));
    splitter.finish(take);
    return lines;
}

TEST_CASE("line_splitter: the same lines however the text is cut, with LF, CR LF and a byte order mark") {
    constexpr std::string_view text = "\xEF\xBB\xBF"
                                      "one\r\ntwo\n\nfour\r\r\nlast";
    const std::vector<taken_line> expected{{"one", 0, 1, true},
                                           {"two", 8, 2, true},
                                           {"", 12, 3, true},
                                           {"four", 13, 4, true},
                                           {"last", 20, 5, false}};
    for (std::size_t piece = 1; piece <= text.size(); ++piece) {
        CAPTURE(piece);
        CHECK(lines_of(text, piece) == expected);
    }
}

TEST_CASE(
    "line_splitter: a line that has not ended is no reason to stop; the taker's word and a long line are") {
    line_splitter splitter;
    std::vector<std::string> lines;
    const auto until_stop = [&](const text_line& line) {
        lines.emplace_back(line.text);
        return line.text != "stop";
    };
    CHECK(splitter.push(bytes_of("begun"), until_stop));
    CHECK(lines.empty());
    CHECK(splitter.number() == 1);
    CHECK(splitter.push(bytes_of(" and ended\nanother"), until_stop));
    CHECK(lines == std::vector<std::string>{"begun and ended"});
    CHECK(splitter.byte() == 16);
    CHECK(splitter.number() == 2);
    CHECK_FALSE(splitter.push(bytes_of("\nstop\nnever seen\n"), until_stop));
    CHECK(lines == std::vector<std::string>{"begun and ended", "another", "stop"});
    CHECK_FALSE(splitter.too_long());

    line_splitter patient;
    const std::string longest(largest_header_bytes, 'x');
    CHECK(patient.push(bytes_of(longest), until_stop));
    CHECK_FALSE(patient.push(bytes_of("x"), until_stop));
    CHECK(patient.too_long());
}

double number(const std::string& text) {
    const auto found = scan_number(text.data(), text.data() + text.size());
    REQUIRE(found.end == text.data() + text.size());
    return found.value;
}

TEST_CASE("measures: numbers are those of the standard library, to the last bit") {
    for (const std::string text :
         {"0", "7", "255", "0.1", ".5", "5.", "123456.789", "999999999999999", "9999999999999999", "1e22",
          "1E-7", "0.30000000000000004", "18446744073709551616", "2.2250738585072014e-308", "000012.5"}) {
        CAPTURE(text);
        CHECK(number(text) == std::strtod(text.c_str(), nullptr));
    }
    std::uint64_t state = 1;
    for (int i = 0; i < 10'000; ++i) {
        state = state * 6364136223846793005U + 1442695040888963407U;
        std::string text = std::to_string(state >> (20 + state % 40));
        text.insert(state % (text.size() + 1), 1, '.');
        REQUIRE(number(text) == std::strtod(text.c_str(), nullptr));
    }
    for (const std::string text : {"", ".", "-1", "x", "nan", "inf", "1e999"})
        CHECK(scan_number(text.data(), text.data() + text.size()).end == nullptr);
}

TEST_CASE("measures: a number and its unit, as makers write them") {
    for (const char* text : {" 1.5 mm ", "1.5mm", "1.5,mm", "1.5 , mm"}) {
        const auto found = tactnet::scan_measure(text);
        REQUIRE(found);
        CHECK(found->number == 1.5);
        CHECK(found->unit == "mm");
    }
    CHECK(tactnet::scan_measure("1.5")->unit.empty());
    for (const char* text : {"1,5 mm", "1.5.2 mm", "mm", "-1 mm", ""})
        CHECK(!tactnet::scan_measure(text));
    CHECK(tactnet::unit_size(tactnet::pressure_units, "KPA") == 1000.0);
    CHECK(!tactnet::unit_size(tactnet::pressure_units, ""));
    for (const char* unit : {"kg/cm2", "Kg/cm^2", "kg/cm\xC2\xB2", "KG/CM\xB2", "(kg/cm\xB2)"})
        CHECK(tactnet::unit_size(tactnet::pressure_units, unit) == 98066.5);
    for (const char* unit : {"mm2", "mm^2", "mm\xC2\xB2", "mm\xB2", "sq mm"})
        CHECK(tactnet::unit_size(tactnet::area_units, unit) == 1e-6);
    for (const char* unit : {"mm", "mm^", "mm\xC2", "mm22", "2", "\xB2"})
        CHECK(!tactnet::unit_size(tactnet::area_units, unit));
    CHECK(!tactnet::unit_size(tactnet::length_units, "m^2"));
}

TEST_CASE("measures: units agree with each other, and with what defines them") {
    const auto pascal = [](std::string_view unit) {
        return tactnet::unit_size(tactnet::pressure_units, unit).value_or(0);
    };
    CHECK(pascal("Pa") == 1);
    CHECK(pascal("kPa") == 1000);
    CHECK(pascal("MPa") == 1000 * pascal("kPa"));
    CHECK(pascal("bar") == 1000 * pascal("mbar"));
    CHECK(pascal("bar") == 100 * pascal("kPa"));
    CHECK(pascal("N/mm2") == 100 * pascal("N/cm2"));
    CHECK(pascal("N/mm2") == pascal("MPa"));
    CHECK(pascal("kg/cm2") == doctest::Approx(9.80665 * pascal("N/cm2")).epsilon(1e-15));
    CHECK(pascal("kgf/cm2") == pascal("kg/cm2"));
    CHECK(pascal("kg/cm2") == doctest::Approx(1000 * pascal("g/cm2")).epsilon(1e-15));
    CHECK(pascal("atm") == 1.01325 * pascal("bar"));
    CHECK(pascal("atm") == doctest::Approx(760 * pascal("torr")).epsilon(1e-15));
    // Mercury's conventional density is 13.5951 times that of a gram a cubic centimetre.
    CHECK(pascal("mmHg") == doctest::Approx(9.80665 * 13.5951).epsilon(1e-11));
    // A pound is 0.45359237 kg, an inch 25.4 mm.
    CHECK(pascal("psi") == doctest::Approx(0.45359237 * 9.80665 / 0.00064516).epsilon(1e-14));

    const auto metres = [](std::string_view unit) {
        return tactnet::unit_size(tactnet::length_units, unit).value_or(0);
    };
    const auto square_metres = [](std::string_view unit) {
        return tactnet::unit_size(tactnet::area_units, unit).value_or(0);
    };
    for (const std::string unit : {"mm", "cm", "m", "in"}) {
        CAPTURE(unit);
        CHECK(square_metres(unit + "2") == doctest::Approx(metres(unit) * metres(unit)).epsilon(1e-15));
        CHECK(square_metres("sq " + unit) == square_metres(unit + "2"));
    }
    for (const char* unit : {"inch2", "inches2", "square inches"})
        CHECK(square_metres(unit) == square_metres("in2"));
    for (const std::string ending : {"meter", "meters", "metre", "metres"}) {
        CHECK(metres(ending) == 1);
        CHECK(metres("centi" + ending) == 0.01);
        CHECK(metres("milli" + ending) == 0.001);
    }
    CHECK(metres("cm") == 10 * metres("mm"));
    CHECK(metres("m") == 1);
    for (const char* unit : {"in", "inch", "inches"})
        CHECK(metres(unit) == 0.0254);

    const auto seconds = [](std::string_view unit) {
        return tactnet::unit_size(tactnet::time_units, unit).value_or(0);
    };
    for (const char* unit : {"s", "sec", "secs", "second", "seconds"})
        CHECK(seconds(unit) == 1);
    for (const char* unit : {"ms", "msec", "msecs", "millisecond", "milliseconds"})
        CHECK(seconds(unit) == 1e-3);
    for (const char* unit : {"us", "usec", "microsecond", "microseconds"})
        CHECK(seconds(unit) == 1e-6);
}

TEST_CASE("measures: the fewest digits") {
    CHECK(tactnet::shortest_text(0.1F) == "0.1");
    CHECK(tactnet::shortest_text(310.0F) == "310");
    CHECK(tactnet::shortest_text(1514730.0) == "1514730");
    CHECK(tactnet::shortest_text(0.00127) == "0.00127");
    CHECK(tactnet::shortest_text(1e300) == "1e+300");
}

} // namespace
