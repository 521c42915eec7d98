#include "decoded.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/tekscan/map.hpp>

#include <doctest/doctest.h>

#include <string>
#include <string_view>
#include <support/files/data_folder.hpp>
#include <vector>

using sensors_test::bytes_of;
using sensors_test::decoded;
using tactnet::decode_status;
using tactnet::tekscan_map;

namespace {

decoded decode(std::string_view text) {
    return sensors_test::decode(tekscan_map(), bytes_of(text));
}

const std::string header =
    "SENSOR_TYPE NULL\r\nROWS 2\r\nCOLS 3\r\nSENSEL_AREA 1\r\nCOMMENT @@\r\n\tROWS 9\r\n@@\r\n"
    "MAP_VERSION 6.4\r\nSENSOR_MAP @@\r\n";

} // namespace

static_assert(tactnet::frame_decoder<tekscan_map>);

TEST_CASE("tekscan_map: the cells that exist, in lines of any length") {
    for (const std::string places :
         {"0, 2, 4\r\n1, 3, 5\r\n", "0,2,4,1\n3 5\n", "0\t2\t4\n\n1\n3,\n5,,,\n"}) {
        const auto found = decode(header + places + "@@\r\n");
        CHECK_MESSAGE(found.status == decode_status::finished, found.error);
        CHECK(found.frames.empty());
        CHECK(found.description.mask == std::vector<std::uint8_t>(6, 1));
    }
    CHECK(decode("UNITS bananas\n" + header + "0,1,2,3,4,5\n@@\n").status == decode_status::finished);
    tekscan_map map;
    const std::string text = header + "7, -1, 4\nB, 65535, 0\n@@\n";
    map.push(bytes_of(text), tactnet::ignore_frames{});
    CHECK(map.finish(tactnet::ignore_frames{}) == decode_status::finished);
    CHECK(map.description().mask == std::vector<std::uint8_t>{1, 0, 1, 0, 0, 1});
    CHECK(map.description().missing_cells() == 3);
    CHECK(std::vector<std::uint16_t>(map.places().begin(), map.places().end()) ==
          std::vector<std::uint16_t>{7, 65535, 4, 65535, 65535, 0});
    CHECK(sensors_test::same_however_split(tekscan_map(), bytes_of(text)));
    CHECK(decode(text + "MORE of its own\n").status == decode_status::finished);
    const std::string cut = header + "7, -1";
    CHECK(decode(cut).error == "byte " + std::to_string(cut.size()) +
                                   ", line 11: expected 6 places and a closing '@@', found the end of the "
                                   "data after 2 places");
    // Without the closing line it is cut short; cut inside it is as well.
    for (std::size_t size = 0; size < text.size() - 3; ++size)
        CHECK(decode(text.substr(0, size)).status == decode_status::damaged);
}

TEST_CASE("tekscan_map: those that make no sense") {
    const auto error = [](const std::string& places) { return decode(header + places + "@@\n").error; };
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
