#include <tactnet/sensors/described/description_file.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

using tactnet::parse_sensor, tactnet::sensor_description;

namespace {

std::string sentence(const std::string& json) {
    try {
        static_cast<void>(parse_sensor(json, "mat.json"));
    } catch (const tactnet::file_error& error) {
        return error.what();
    }
    return {};
}

} // namespace

TEST_CASE("description: what is written reads as the same; defaults are left out") {
    CHECK(tactnet::sensor_json({.rows = 16, .columns = 8}) == R"({"rows": 16, "columns": 8})");
    const std::string all =
        R"({"rows": 4, "columns": 6, "cell": "int16", "byte_order": "big", "order": "columns", )"
        R"("serpentine": true, "blocks": "side by side", "transposed": true, "flipped_rows": true, )"
        R"("flipped_columns": true, "rotation": 90, "marker": "AA 55", "header_bytes": 1, "trailer_bytes": 2, )"
        R"("checksum": {"kind": "crc16", "with_marker": false, "byte_order": "big", "polynomial": 32773, )"
        R"("initial": 65535, "final_xor": 1, "reflected": true}, "end_bytes": 3, "seconds_per_frame": 0.01, )"
        R"("offset": 2135.5, "inverted": true, "negative_is_zero": true, "full_scale": 2135, )"
        R"("full_scale_pressure": 34000, "broken": ["nan", -1, "inf"], "broken_above": 3000, )"
        R"("row_spacing": 0.001, "column_spacing": 0.002})";
    const sensor_description read = parse_sensor(all);
    CHECK(tactnet::sensor_json(read) == all);
    CHECK(read.packet_bytes() == 2 + 1 + 48 + 2 + 2 + 3);
    CHECK(std::isnan(read.broken[0]));
    CHECK(read.frame_rows() == 4); // transposed and rotated
    CHECK(parse_sensor(R"({"columns":3,"rows":2,"rotation":270})").frame_rows() == 3);
}

TEST_CASE("description: what cannot be is a sentence with the field, expected and found") {
    CHECK(sentence(R"({"rows": 0, "columns": 2})") ==
          "mat.json: field 'rows': expected 1 to 1048576, found 0");
    CHECK(sentence(R"({"rows": 2})") ==
          "mat.json: field 'columns': expected 1 to 1048576 cells, found 2 x 0");
    CHECK(sentence(R"({"rows": 2, "columns": 2, "cell": "uint7"})") ==
          "mat.json: field 'cell': expected one of 'uint8', 'int8', 'uint16', 'int16', 'uint32', 'int32', "
          "'uint64', 'int64', 'float32', 'float64', 'digits', found 'uint7'");
    CHECK(sentence(R"({"rows": 2, "columns": 2, "marker": "AA 5"})") ==
          "mat.json: field 'marker': expected two hexadecimal digits for each byte, found 'AA 5'");
    CHECK(sentence(R"({"rows": 2, "columns": 3, "blocks": "side by side"})") ==
          "mat.json: field 'blocks': expected an even number of columns, found 3");
    CHECK(sentence(R"({"rows": 2, "columns": 2, "rotation": 45})") ==
          "mat.json: field 'rotation': expected 0, 90, 180 or 270, found 45");
    CHECK(sentence(R"({"rows": 2, "columns": 2, "cell": "digits", "marker": "AA"})").find("field 'cell'") !=
          std::string::npos);
    CHECK(sentence(R"({"rows": 2, "columns": 2, "broken": ["none"]})") ==
          "mat.json: field 'broken': expected a number, 'nan', 'inf' or '-inf', found 'none'");
    CHECK(sentence(R"({"rows": 2, "columns": 2, "offset": 1e999})").find("a number that a double can hold") !=
          std::string::npos);
    CHECK(sentence(R"({"rows": 2, "columns": 2, "checksum": {"initial": 65536}})") ==
          "mat.json: field 'initial': expected at most 65535, found 65536");
    CHECK(sentence(R"({"rows": 2, "columns": 2, "serpentine": 1})") ==
          "mat.json: description, byte 40: expected true or false, found '1'");
    CHECK(sentence(R"({"rows": 2, "colums": 2})")
              .starts_with("mat.json: field 'colums': expected one of: rows, "));
    for (const double value : {-1.0, 0.0, 1e-31, 1e31})
        CHECK(
            sentence(R"({"rows": 1, "columns": 1, "full_scale": )" + tactnet::shortest_number(value) + "}") ==
            "mat.json: field 'full_scale': expected 1e-30 to 1e30, found " + tactnet::shortest_number(value));
    CHECK_NOTHROW(tactnet::require_valid({.rows = 1, .columns = 1, .broken = std::vector<double>(256, 1)}));
    CHECK_THROWS_WITH_AS(
        tactnet::require_valid({.rows = 1, .columns = 1, .broken = std::vector<double>(257, 1)}),
        "sensor description: 'broken': expected at most 256 values, found 257", std::invalid_argument);
}
