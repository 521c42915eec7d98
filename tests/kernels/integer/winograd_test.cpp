#include "comparison.hpp"

#include <doctest/doctest.h>

// Tiles in integers: the same sums as those of the direct method.

using namespace integer_test;

namespace {

template <frame_convolution C, class Output = std::uint8_t>
std::size_t tiles_differing(numbers_are kind = numbers_are::drawn) {
    using method = kernels::winograd_integer_method<C, std::uint8_t>;
    if constexpr (method::tiles::possible)
        return differing<method, C, std::uint8_t, Output>(kind);
    else
        return 0;
}

} // namespace

TEST_CASE("winograd_integer_method: kernels of 3 x 3 and 2 x 2 give the sums of plain loops") {
    // Without vectors, tiles take longer than plain loops.
    static_assert(kernels::integer_tiles<of({6, 8, 8}, 8, 3)>::possible == (kernels::max_integer_lanes > 1));
    CHECK(tiles_differing<of({6, 8, 8}, 8, 3)>() == 0);
    CHECK(tiles_differing<of({7, 5, 16}, 33, 3)>() == 0);
    CHECK(tiles_differing<of({5, 7, 12}, 5, 2)>() == 0);
    CHECK(tiles_differing<of({4, 9, 4}, 16, 3, 1, pad(2))>() == 0);
    CHECK(tiles_differing<of({5, 6, 5}, 8, 3, 1, padding::valid, 8)>() == 0);
}

TEST_CASE("winograd_integer_method: pools, sums, wider maps and floats") {
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 16, 3), 2, 4, 5)>() == 0);
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 8, 2), 2, 3, 4, false)>() == 0);
    CHECK(tiles_differing<adding(of({5, 7, 4}, 8, 3), true)>() == 0);
    CHECK(tiles_differing<among(of({4, 5, 4}, 8, 3), 32, 16)>() == 0);
    CHECK(tiles_differing<pooled(of({5, 6, 4}, 6, 3), 1, 5, 6), float>() == 0);
}

TEST_CASE("winograd_integer_method: the largest bytes and weights do not overflow") {
    CHECK(tiles_differing<of({3, 3, 16}, 16, 3)>(numbers_are::largest) == 0);
    CHECK(tiles_differing<of({3, 4, 1024}, 4, 3)>(numbers_are::largest) == 0);
}
