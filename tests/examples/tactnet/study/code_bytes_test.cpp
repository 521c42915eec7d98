// What networks take of a program: the table that the build writes, read and told.

#include "rows.hpp"
#include "table_file.hpp"

#include <doctest/doctest.h>

#include <string>
#include <study/page/markdown.hpp>
#include <study/times/code_bytes.hpp>
#include <vector>

using namespace support;

namespace {

constexpr auto& parsed = read_table<read_code_bytes>;
constexpr auto& refused = refused_table<read_code_bytes>;

} // namespace

TEST_SUITE("the program tactnet") {
    TEST_CASE("read_code_bytes: networks, sizes, bits and bytes") {
        const auto sizes =
            parsed("network,bits,bytes\ntactnet6/28x50,32,30303\r\ntactnet6-economical/7x13,8,9000\n");
        REQUIRE(sizes.size() == 2);
        CHECK(sizes[0].method == "tactnet6");
        CHECK(sizes[0].rows == 28);
        CHECK(sizes[0].columns == 50);
        CHECK(sizes[0].bits == 32);
        CHECK(sizes[0].bytes == 30303);
        CHECK(sizes[1].method == "tactnet6-economical");
        CHECK(sizes[1].bits == 8);
        CHECK(sizes[1].bytes == 9000);
    }

    TEST_CASE("read_code_bytes: refuses what is no such table, with its place") {
        const std::string head = "network,bits,bytes\n";
        CHECK(refused("network,bytes\n").starts_with("line 1: expected the head of a table of the target"));
        CHECK(refused(head + "tactnet6,32,5\n") ==
              "line 2: expected a network and its size, such as tactnet6/28x50, found 'tactnet6'");
        CHECK(refused(head + "tactnet6/28x50,32\n").starts_with("line 2: expected 3 columns"));
        CHECK(refused(head + "tactnet6/28x50,16,5\n") ==
              "line 2: expected 8 or 32 bits of a weight, found '16'");
        for (const char* bytes : {"0", "-1", "1e3", ""})
            CHECK_MESSAGE(refused(head + "tactnet6/28x50,32," + bytes + "\n") != "nothing", bytes);
    }

    TEST_CASE("study_markdown: a table of memory where bytes of code are known, once for all recipes") {
        study_row known = studied("net", 0.9, 10), thorough = studied("net", 0.95, 10, "thorough");
        known.costs.parameter_bytes = 1234;
        known.costs.activation_bytes = 5678;
        CHECK(study_markdown({known}, "images").find("<!-- study memory -->") == std::string::npos);
        known.code_bytes = thorough.code_bytes = 30'303;
        const std::string text = study_markdown({known, studied("other", 0.8, 5), thorough}, "images");
        const std::string table = text.substr(text.find("<!-- study memory -->"));
        CHECK(table.find("| net | 7 × 13 | 1 234 | 5 678 | 30 303 |\n<!--") != std::string::npos);
        CHECK(table.find("other") == std::string::npos);
        CHECK(table.find("thorough") == std::string::npos);
    }
}
