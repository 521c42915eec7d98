#include <tactnet/kernels/frame/methods.hpp>

#include <doctest/doctest.h>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// The tile of the chosen method, 0 for one without tiles.
template <frame_convolution C>
constexpr extent2d chosen_tile = convolution_method<C>::tile;

constexpr frame_convolution step(shape in, extent2d kernel, std::size_t filters, std::size_t input_stride,
                                 extent2d stride = 1) {
    return {.window = sliding_window::over(in, kernel, stride, padding::same),
            .filters = filters,
            .input_stride = input_stride};
}
constexpr frame_convolution pooled(frame_convolution c) {
    c.pool = 2, c.relu = true;
    c.pooled_rows = (c.window.output_rows() + 1) / 2, c.pooled_columns = (c.window.output_columns() + 1) / 2;
    return c;
}

} // namespace

TEST_CASE("convolution_method: Winograd where it saves, and large tiles for wide vectors alone") {
    constexpr bool wide = lanes<float> >= 8;
    // A few pixels or channels are taps; a wide map of many channels is tiles.
    CHECK(chosen_tile<step({1, 2, 64}, 3, 128, 64)> == extent2d(0));
    CHECK(chosen_tile<step({28, 50}, 5, 8, 1)> == extent2d(0));
    CHECK(chosen_tile<step({28, 50, 8}, 3, 16, 8, 2)> == extent2d(0));
    const extent2d large = chosen_tile<step({10, 18, 32}, 3, 64, 32)>;
    CHECK(large == (wide ? extent2d(4, 3) : extent2d(2)));
    CHECK(chosen_tile<step({10, 18, 64}, 2, 128, 64)> == (wide ? extent2d(5, 3) : extent2d(2)));
    // Transforms with points at roots cost more, so that here two rows are better than four.
    constexpr bool widest = lanes<float> == 16;
    CHECK(chosen_tile<pooled(step({14, 25, 8}, 3, 16, 8))> == (widest ? extent2d(2, 4)
                                                               : wide ? extent2d(4)
                                                                      : extent2d(2)));
    // Four tiles that share a weight are enough for a register block.
    if (widest)
        CHECK(chosen_tile<pooled(step({4, 7, 8}, 3, 16, 8))> == extent2d(2, 4));
    // Weights beyond the second level: fewer of them, though more tiles.
    CHECK(chosen_tile<step({6, 12, 128}, 3, 128, 128)> == (wide ? extent2d(2, 4) : extent2d(2)));
    CHECK_FALSE(tile_possible(step({6, 12, 128}, 3, 128, 128), {1, 3}));
    // A window of a pool lies in one tile.
    const extent2d behind = chosen_tile<pooled(step({7, 13, 64}, 2, 128, 64))>;
    CHECK(behind.rows % 2 == 0);
    CHECK(behind.columns % 2 == 0);
}
