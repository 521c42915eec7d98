#include <tactnet/kernels/panels/tiles.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <kernels/panels/comparison.hpp>

using namespace tactnet;
using kernels::frame_convolution;
using support::several_lanes;

namespace {

frame_convolution step(shape in, std::size_t filters, padding around = padding::same,
                       std::size_t input_stride = 0) {
    return {.window = sliding_window::over(in, 3, 1, around),
            .filters = filters,
            .input_stride = input_stride > 0 ? input_stride : in.channels};
}
/// Behind it a max pool of 2 × 2; `whole` leaves out windows that the image does not fill.
frame_convolution pooled(frame_convolution c, bool whole) {
    const std::size_t rows = c.window.output_rows(), columns = c.window.output_columns();
    c.pool = 2, c.relu = true;
    c.pooled_rows = whole ? rows / 2 : (rows + 1) / 2;
    c.pooled_columns = whole ? columns / 2 : (columns + 1) / 2;
    return c;
}

} // namespace

TEST_CASE("tile_plan: tiles of four where they save a third and meet their weights, else of two, else taps") {
    const auto outputs = [](shape in) { return kernels::tile_plan(step(in, several_lanes)).outputs; };
    CHECK(outputs({56, 56, several_lanes}) == 4);
    CHECK(outputs({28, 28, several_lanes}) == 4);
    CHECK(outputs({14, 14, several_lanes}) == 2);
    CHECK(outputs({7, 7, several_lanes}) == 2);
    CHECK(outputs({4, 4, several_lanes}) == 0);
}

TEST_CASE("convolve_tiles: outputs of two and of four a side, odd sizes and paddings") {
    support::compare_large(step({7, 7, several_lanes}, several_lanes), 2, 1);
    support::compare_large(step({13, 14, several_lanes}, several_lanes + 1), 2, 2);
    support::compare_large(step({28, 24, several_lanes}, several_lanes), 4, 3);
    support::compare_large(step({25, 31, several_lanes}, 3 * several_lanes, pad(1, 0, 2, 1)), 4, 4);
    support::compare_large(step({26, 26, several_lanes}, several_lanes, padding::valid, 2 * several_lanes), 4,
                           5);
    support::compare_large(step({8, 8, 512}, several_lanes), 2, 6); // channels that would clash
}

TEST_CASE("convolve_tiles: pools, sums and ReLU") {
    support::compare_large(pooled(step({13, 14, several_lanes}, several_lanes), false), 2, 1);
    support::compare_large(pooled(step({15, 15, several_lanes}, several_lanes), true), 2, 1);
    for (const bool whole : {false, true})
        support::compare_large(pooled(step({27, 29, several_lanes}, several_lanes), whole), 4, 2);
    for (frame_convolution c :
         {step({9, 14, several_lanes}, several_lanes), step({24, 27, several_lanes}, several_lanes)}) {
        c.accumulates = true;
        const std::size_t outputs = kernels::tile_plan(c).outputs;
        CHECK(outputs > 0);
        support::compare_large(c, outputs, 3);
        c.relu = true;
        support::compare_large(c, outputs, 4);
    }
}
