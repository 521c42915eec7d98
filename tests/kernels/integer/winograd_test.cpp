#include "comparison.hpp"

#include <tactnet/kernels/integer/winograd.hpp>

#include <doctest/doctest.h>

// Tiles in whole numbers: the very sums of taps.

using namespace integer_test;

namespace {

template <frame_convolution C, class Output = std::uint8_t>
std::size_t tiles_differing(numbers_are kind = numbers_are::drawn) {
    using tiles = kernels::integer_tiles<C>;
    if constexpr (!tiles::possible) {
        return 0;
    } else {
        constexpr std::size_t guard = 64;
        const given<C, std::uint8_t> numbers(kind);
        aligned_vector<std::int8_t> packed(tiles::weight_bytes + guard, std::int8_t{99});
        kernels::pack_integer_tiles<C>(packed.data(),
                                       [&](auto... place) { return numbers.weight(place...); });
        std::size_t wrong = guard_touched(packed, tiles::weight_bytes, 99);
        aligned_vector<std::uint8_t> scratch(tiles::scratch_bytes + guard, std::uint8_t{0x5a});
        const auto run = [&](Output* to, bool) {
            kernels::convolve_integer_tiles<C>(numbers.input.data(), packed.data(),
                                               {as_bytes(numbers.starts), as_bytes(numbers.factors),
                                                as_bytes(numbers.added), numbers.range()},
                                               to, scratch.data(), numbers.padding);
        };
        wrong += outputs_differing<C, std::uint8_t, Output>(numbers, run, true);
        return wrong + guard_touched(scratch, tiles::scratch_bytes, 0x5a);
    }
}

} // namespace

TEST_CASE("convolve_integer_tiles: kernels of 3 x 3 and 2 x 2 give the sums of plain loops") {
    static_assert(kernels::integer_tiles<of({6, 8, 8}, 8, 3)>::possible);
    CHECK(tiles_differing<of({6, 8, 8}, 8, 3)>() == 0);
    CHECK(tiles_differing<of({7, 5, 16}, 33, 3)>() == 0);
    CHECK(tiles_differing<of({5, 7, 12}, 5, 2)>() == 0);
    CHECK(tiles_differing<of({4, 9, 4}, 16, 3, 1, pad(2))>() == 0);
    CHECK(tiles_differing<of({5, 6, 5}, 8, 3, 1, padding::valid, 8)>() == 0);
}

TEST_CASE("convolve_integer_tiles: pools, sums, wider maps and floats") {
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 16, 3), 2, 4, 5)>() == 0);
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 8, 2), 2, 3, 4, false)>() == 0);
    CHECK(tiles_differing<adding(of({5, 7, 4}, 8, 3), true)>() == 0);
    CHECK(tiles_differing<among(of({4, 5, 4}, 8, 3), 32, 16)>() == 0);
    CHECK(tiles_differing<pooled(of({5, 6, 4}, 6, 3), 1, 5, 6), float>() == 0);
}

TEST_CASE("convolve_integer_tiles: the largest bytes and weights do not overflow") {
    CHECK(tiles_differing<of({3, 3, 16}, 16, 3)>(numbers_are::largest) == 0);
    CHECK(tiles_differing<of({3, 4, 1024}, 4, 3)>(numbers_are::largest) == 0);
}
