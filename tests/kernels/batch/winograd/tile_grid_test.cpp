#include <tactnet/kernels/batch/methods.hpp>

#include <doctest/doctest.h>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

constexpr batch_convolution ahead(shape in, std::size_t filters, extent2d kernel = 3, extent2d stride = 1,
                                  padding around = padding::same) {
    return batch_convolution::forward(sliding_window::over(in, kernel, stride, around), filters);
}
constexpr batch_convolution back(shape in, std::size_t filters, extent2d kernel = 3, extent2d stride = 1,
                                 padding around = padding::same) {
    return batch_convolution::backward(sliding_window::over(in, kernel, stride, around), filters);
}

} // namespace

TEST_CASE("tile_grid: tiles cover the outputs, also where they reach beyond") {
    constexpr tile_grid tiles = tile_grid::of(ahead({7, 13, 16}, 32), {4, 3});
    CHECK(tiles.side == extent2d(6, 5));
    CHECK(tiles.elements() == 30);
    CHECK(tiles.rows == 2);
    CHECK(tiles.columns == 5);
    CHECK(tiles.count() == 10);
}

TEST_CASE("tile_grid: the elements of a tile lie an odd number of cache lines apart") {
    for (const std::size_t count : {1U, 16U, 17U, 31U, 32U, 33U, 100U}) {
        CHECK(odd_lines<float>(count) >= count);
        CHECK(odd_lines<float>(count) < count + 32);
        CHECK(odd_lines<float>(count) % 32 == 16);
        CHECK(odd_lines<double>(count) % 16 == 8);
    }
}

TEST_CASE("tile_grid: kernels, strides and paddings that have no tile") {
    CHECK(winograd_possible(ahead({7, 13, 16}, 32), 4));
    CHECK(winograd_possible(ahead({7, 13, 16}, 32, 2), 5));
    CHECK_FALSE(winograd_possible(ahead({7, 13, 16}, 32), 5)); // 7 numbers have no line
    CHECK_FALSE(winograd_possible(ahead({7, 13, 16}, 32), {1, 4}));
    CHECK_FALSE(winograd_possible(ahead({7, 13, 16}, 32, 5), 2));
    CHECK_FALSE(winograd_possible(ahead({7, 13, 16}, 32, {2, 3}), 2));
    CHECK_FALSE(winograd_possible(ahead({7, 13, 16}, 32, 3, 2), 2));
    CHECK_FALSE(winograd_possible(back({7, 13, 16}, 32, 3, 2), 2)); // the same backwards: pixels apart
    CHECK(winograd_possible(ahead({7, 13, 16}, 32, 3, 1, pad(2, 9, 2, 9)), 2));
    CHECK_FALSE(winograd_possible(ahead({7, 13, 16}, 32, 3, 1, pad(3, 0, 0, 0)), 2)); // outputs of nothing
    CHECK_FALSE(winograd_possible(ahead({7, 13, 16}, 32, 3, 1, pad(0, 0, 3, 0)), 2));
    CHECK(winograd_possible(back({7, 13, 16}, 32, 3, 1, pad(2)), 2));
    CHECK_FALSE(winograd_possible(back({7, 13, 16}, 32, 3, 1, pad(3)), 2)); // pixels that no tap reads
}

TEST_CASE("tile_grid: taps on padding are not counted") {
    const auto same_as_window = [](shape in, extent2d kernel, padding around) {
        const auto window = sliding_window::over(in, kernel, 1, around);
        const std::size_t expected = 2 * window.taps_on_pixels() * in.channels * 5;
        CHECK(direct_cost(batch_convolution::forward(window, 5)) == expected);
        CHECK(direct_cost(batch_convolution::backward(window, 5)) == expected);
    };
    same_as_window({7, 13, 16}, 3, padding::same);
    same_as_window({1, 2, 3}, 3, padding::same);
    same_as_window({4, 7, 2}, 2, padding::same);
    same_as_window({4, 7, 2}, 3, padding::valid);
    same_as_window({4, 7, 2}, 3, pad(2));
}

TEST_CASE("tile_grid: large tiles where they save products, none where transforms cost more") {
    CHECK(best_tile(ahead({4, 7, 32}, 64)) == extent2d(4));
    CHECK(best_tile(back({4, 7, 32}, 64)) == extent2d(4));
    CHECK(best_tile(ahead({2, 4, 64}, 128)) == extent2d(2, 4));
    CHECK(best_tile(ahead({1, 9, 64}, 128)) == extent2d(0)); // two of three rows of taps are on padding
    CHECK(best_tile(ahead({28, 50, 1}, 8)) == extent2d(0));  // one channel
    CHECK(best_tile(ahead({1, 1, 64}, 64)) == extent2d(0));  // one tap
    // The way does not depend on the instruction set nor on the precision.
    CHECK(winograd_lane_method<ahead({4, 7, 32}, 64), float>::tile == extent2d(4));
    CHECK(winograd_lane_method<ahead({4, 7, 32}, 64), double>::tile == extent2d(4));
}
