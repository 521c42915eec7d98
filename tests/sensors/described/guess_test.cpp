#include "../decoded.hpp"

#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/sensors/described/guess.hpp>
#include <tactnet/sensors/described/matrix_stream.hpp>

#include <doctest/doctest.h>

#include <random>
#include <string>

using sensors_test::bytes_of;

namespace {

std::string guessed(const std::string& text) {
    const auto found = tactnet::guess_sensor(bytes_of(text));
    return found ? tactnet::sensor_json(*found) : "none";
}

} // namespace

TEST_CASE("guess_sensor: lines and tables") {
    std::string lines, rows, stamped, european;
    std::mt19937 random(3);
    for (int frame = 0; frame < 9; ++frame) {
        stamped += std::to_string(1000 + 10 * frame) + ",";
        for (int cell = 0; cell < 16; ++cell) {
            const std::string count = std::to_string(random() % 1000);
            lines += count + "\t";
            stamped += count + (cell < 15 ? "," : "\n");
            rows += count + (cell % 4 < 3 ? "," : "\n");
            european += count + ",5" + (cell < 15 ? ";" : "\n");
        }
        lines += "\r\n";
        rows += "\n";
    }
    CHECK(guessed(lines) == R"({"rows": 4, "columns": 4, "cell": "digits"})");
    CHECK(guessed("a;b\n" + european) ==
          R"({"rows": 4, "columns": 4, "cell": "digits", "header_lines": 1, "decimal_comma": true})");
    CHECK(guessed(rows) == R"({"rows": 4, "columns": 4, "cell": "digits", "line": "row"})");
    CHECK(guessed(stamped) ==
          R"({"rows": 4, "columns": 4, "cell": "digits", "leading_fields": 1, "seconds_per_tick": 0.001})");
    CHECK(guessed("hello\nworld\n") == "none");
    CHECK(guessed("") == "none");
}

TEST_CASE("guess_sensor: packets, with what a decoder then reads") {
    std::mt19937 random(3);
    for (const auto& [cell, checksum] :
         {std::pair(tactnet::cell_type::uint8, tactnet::checksum_kind::none),
          std::pair(tactnet::cell_type::uint16, tactnet::checksum_kind::crc16),
          std::pair(tactnet::cell_type::uint8, tactnet::checksum_kind::xor8)}) {
        const tactnet::sensor_description array{.rows = 16,
                                                .columns = 16,
                                                .cell = cell,
                                                .marker = {std::byte{0xAA}, std::byte{0x55}},
                                                .checksum = {.kind = checksum}};
        std::string stream;
        for (int frame = 0; frame < 40; ++frame) {
            std::string packet = "\xAA\x55";
            for (int i = 0; i < 256; ++i) {
                packet += static_cast<char>(random() % 256);
                packet.append(array.cell_size() - 1, static_cast<char>(random() % 4));
            }
            const auto sum = tactnet::checksum_of(array.checksum)(bytes_of(packet));
            if (array.checksum.bytes() > 0)
                packet += static_cast<char>(sum & 255U);
            if (array.checksum.bytes() > 1)
                packet += static_cast<char>(sum >> 8U);
            stream += packet;
        }
        const auto found = tactnet::guess_sensor(bytes_of(stream.substr(77)));
        REQUIRE(found);
        CHECK(tactnet::sensor_json(*found) == tactnet::sensor_json(array));
        CHECK(
            sensors_test::decode(tactnet::matrix_stream(*found), bytes_of(stream.substr(77))).frames.size() >=
            38);
    }
}
