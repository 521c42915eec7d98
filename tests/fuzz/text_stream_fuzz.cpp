// Any bytes as lines of numbers of described arrays.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/described/text_stream.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace {

constexpr std::array<std::string_view, 4> descriptions{
    R"({"rows": 1, "columns": 3, "cell": "digits"})",
    R"({"rows": 2, "columns": 2, "cell": "digits", "line": "row", "header_lines": 1, "rotation": 90})",
    R"({"rows": 1, "columns": 2, "cell": "digits", "decimal_comma": true, "offset": 7, "inverted": true,
        "leading_fields": 2, "seconds_per_tick": 0.001})",
    R"({"rows": 1, "columns": 2, "cell": "digits", "broken": ["nan", "inf", -1], "broken_above": 1000})"};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto known = fuzz::parsed(descriptions);
    fuzz_forms(size, known.size(), [&](std::size_t i) {
        fuzz::check(tactnet::text_stream(known[i]), fuzz::bytes_of(data, size), fuzz::cells_of::described);
    });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    return {fuzz::input("1,2,3\n4,5,6\r\n"), fuzz::input("a b\n1;2\n3;4\n\n5\t6\n7\t8\t\n\n"),
            fuzz::input("12,5;P: 3,25;4\n13;P;0;7,\n"), fuzz::input("nan, -1\n-inf,1e3\n+2.5 , 1001\n")};
}
