// Results as text for programs.

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <reports/report.hpp>
#include <string>
#include <vector>

namespace {

using object = nlohmann::ordered_json;

std::string csv(const std::vector<object>& rows) {
    return csv_of(rows);
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("csv_of: a head and a line for each object, in the order of their members") {
        CHECK(csv({}).empty());
        CHECK(csv({object{{"name", "b"}, {"count", 3}, {"share", 0.5}},
                   object{{"name", "a"}, {"count", 18'446'744'073'709'551'615U}, {"share", 1e-300}}}) ==
              "name,count,share\nb,3,0.5\na,18446744073709551615,1e-300\n");
    }

    TEST_CASE("csv_of: what is not known is an empty field, also at either end") {
        CHECK(csv({object{{"a", nullptr}, {"b", 1}, {"c", nullptr}}}) == "a,b,c\n,1,\n");
        CHECK(csv({object{{"a", std::nan("")}, {"b", std::numeric_limits<double>::infinity()}, {"c", 1}}}) ==
              "a,b,c\n,,1\n");
        CHECK(csv({object{{"a", nullptr}, {"b", nullptr}}, object{{"a", 1}, {"b", 2}}}) == "a,b\n,\n1,2\n");
        CHECK(csv({object{{"a", ""}, {"b", 1}}}) == "a,b\n,1\n");
    }

    TEST_CASE("csv_of: text that would end its field is in quotes") {
        CHECK(
            csv({object{{"a", "one, two"}, {"b", "\"so\""}, {"c", "a\nb"}, {"d", "a\rb"}, {"e", "it's"}}}) ==
            "a,b,c,d,e\n\"one, two\",\"\"\"so\"\"\",\"a\nb\",\"a\rb\",it's\n");
    }
}
