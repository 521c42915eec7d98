// Any bytes as packets of described arrays: each type of cell, with and without marker and checksum, and
// orders of the cells.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/described/matrix_stream.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace {

constexpr std::array<std::string_view, 8> descriptions{
    R"({"rows": 2, "columns": 3})",
    R"({"rows": 1, "columns": 2, "cell": "float32", "broken": ["nan", -1]})",
    R"({"rows": 2, "columns": 3, "cell": "int16", "byte_order": "big", "offset": 2135.5, "inverted": true})",
    R"({"rows": 2, "columns": 3, "order": "columns", "marker": "4D 4D 58", "header_bytes": 1, "trailer_bytes": 2,
        "seconds_per_frame": 0.5})",
    R"({"rows": 1, "columns": 4, "marker": "4D", "serpentine": true, "rotation": 90})",
    R"({"rows": 2, "columns": 2, "cell": "uint16", "marker": "4D 4D", "checksum": {"kind": "xor8"},
        "broken": [255], "broken_above": 3000})",
    R"({"rows": 2, "columns": 2, "blocks": "stacked", "marker": "4D 58", "checksum": {"kind": "crc16",
        "reflected": true, "with_marker": false}, "end_bytes": 1})",
    R"({"rows": 1, "columns": 2, "cell": "uint32", "checksum": {"kind": "sum8", "negated": true}})"};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto known = fuzz::parsed(descriptions);
    fuzz_forms(size, 2 * known.size(), [&](std::size_t i) {
        fuzz::check(tactnet::matrix_stream(known[i / 2], static_cast<tactnet::frame_delivery>(i % 2)),
                    fuzz::bytes_of(data, size), fuzz::cells_of::described);
    });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    using namespace std::string_view_literals;
    return {fuzz::input("MMX_\1\2\3\4\5\6__MMX_\6\5\4\3\2\1__"sv), fuzz::input("xMMMX_abcdef__MMX_"sv),
            fuzz::input("MM\1\0\2\0\3\0\4\0\4MM\1\0\2\0\3\0\4\0\4MX\1\2\3\4MX\1\2\3\4"sv),
            fuzz::input("\0\0\x80\x3F\0\0\0\x40\0\0\x80\x7F\0\0\0\0\0\0\x80\xBF\0\0\xC0\x7F"sv)};
}
