// Any bytes as plain streams of matrices, in every form of a cell.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/matrix_stream.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace {

using tactnet::matrix_stream, tactnet::matrix_stream_format;

const std::vector<std::byte> marker{std::byte{'M'}, std::byte{'M'}, std::byte{'X'}};

matrix_stream_format form(tactnet::cell_format cell, bool marked) {
    matrix_stream_format format{.rows = 2, .columns = 3, .cell = cell};
    if (marked) {
        format.order = tactnet::cell_order::columns;
        format.marker = marker;
        format.skip_before = 1;
        format.skip_after = 2;
        format.seconds_per_frame = 0.5;
    }
    return format;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using enum tactnet::cell_format;
    constexpr std::array cells{uint8, uint16_little, uint16_big, float32_little};
    fuzz_forms(size, 2 * cells.size(), [&](std::size_t i) {
        fuzz::check(matrix_stream(form(cells[i / 2], i % 2 == 1)), fuzz::bytes_of(data, size));
    });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    using namespace std::string_view_literals;
    return {fuzz::input("MMX_\1\2\3\4\5\6__MMX_\6\5\4\3\2\1__"sv), fuzz::input("xMMMX_abcdef__MMX_"sv),
            fuzz::input("\0\0\x80\x3F\0\0\0\x40\0\0\x80\x7F\0\0\0\0\0\0\x80\xBF\0\0\xC0\x7F"sv)};
}
