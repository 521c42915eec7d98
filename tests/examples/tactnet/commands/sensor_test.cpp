// tactnet sensor: what a recording looks like, and a description to start from.

#include "../workshop.hpp"

#include <fstream>

using namespace support;

TEST_SUITE("program") {
    TEST_CASE("sensor: a description is proposed, and reads the file") {
        const workshop shop;
        const fs::path table = shop / "table.txt", json = shop / "mat.json";
        std::ofstream(table) << "2135,2135,2000,2135\n2135,65535,2100,2135\n2130,2135,1900,2135\n";
        const outcome found = shop.run({"sensor", table.string()});
        CHECK(found.status == 0);
        CHECK(found.out.find("text: 3 frames of 2 x 2\ncounts from 1900 to 65535\nno cell is ever zero") ==
              0);
        CHECK(found.out.find(R"({"rows": 2, "columns": 2, "cell": "digits"})") != std::string::npos);
        std::ofstream(json)
            << R"({"rows": 2, "columns": 2, "cell": "digits", "offset": 2135, "inverted": true,)"
            << R"( "broken": [65535]})";
        const outcome read = shop.run({"sensor", table.string(), "--sensor", json.string()});
        CHECK(read.status == 0);
        CHECK(read.out == "text: 3 frames of 2 x 2\ncounts from 0 to 235\n1 broken cells in all frames\n");
    }

    TEST_CASE("sensor: what is nothing of the kind, and wrong descriptions, are sentences") {
        const workshop shop;
        const fs::path other = shop / "other.bin", json = shop / "mat.json";
        std::ofstream(other) << "nothing of the kind\n";
        const outcome none = shop.run({"sensor", other.string()});
        CHECK(none.status == 2);
        CHECK(none.error.find("expected a recording, lines of numbers or packets that repeat, found none") !=
              std::string::npos);
        std::ofstream(json) << R"({"rows": 2, "columns": 0})";
        const outcome wrong = shop.run({"sensor", other.string(), "--sensor", json.string()});
        CHECK(wrong.status == 2);
        CHECK(wrong.error.find("field 'columns': expected 1 to 1048576 cells, found 2 x 0") !=
              std::string::npos);
    }
}
