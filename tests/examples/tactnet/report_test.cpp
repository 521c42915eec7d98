// Results as text for programs.

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <reports/report.hpp>
#include <string>
#include <utility>
#include <vector>

using object = nlohmann::ordered_json;

TEST_CASE("csv_of: a head and a line for each object, empty fields for what is not known") {
    const std::pair<std::vector<object>, const char*> cases[]{
        {{}, ""},
        {{{{"name", "b"}, {"count", 18'446'744'073'709'551'615U}}, {{"name", ""}, {"count", 1e-300}}},
         "name,count\nb,18446744073709551615\n,1e-300\n"},
        {{{{"a", nullptr}, {"b", std::nan("")}}, {{"a", 1}, {"b", std::numeric_limits<double>::infinity()}}},
         "a,b\n,\n1,\n"},
        {{{{"a", "one, two"}, {"b", "\"so\""}, {"c", "a\nb"}, {"d", "a\rb"}, {"e", "it's"}}},
         "a,b,c,d,e\n\"one, two\",\"\"\"so\"\"\",\"a\nb\",\"a\rb\",it's\n"},
    };
    for (const auto& [rows, text] : cases)
        CHECK(csv_of(rows) == text);
}
