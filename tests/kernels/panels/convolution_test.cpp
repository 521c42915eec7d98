#include <tactnet/kernels/panels/convolution.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <kernels/panels/comparison.hpp>

using namespace tactnet;
using kernels::frame_convolution;
using support::several_lanes;

namespace {

constexpr frame_convolution step(shape in, extent2d kernel, std::size_t filters, std::size_t input_stride,
                                 extent2d stride = 1, padding around = padding::same) {
    return {.window = sliding_window::over(in, kernel, stride, around),
            .filters = filters,
            .input_stride = input_stride};
}

} // namespace

TEST_CASE("panel_plan: an image whose pixels stand for themselves is one row, one under a single kernel one "
          "pixel") {
    constexpr kernels::panel_plan row(step({14, 13, 96}, 1, 64, 96));
    static_assert(row.flat() && row.convolution.window.input == shape{1, 182, 96} && !row.staged);
    constexpr kernels::panel_plan pixel(step({6, 5, 32}, extent2d(6, 5), 64, 32, 1, padding::valid));
    static_assert(pixel.flat() && pixel.convolution.window.input == shape{1, 1, 960} && !pixel.staged);
    // Not where there are gaps between the pixels, or padding.
    constexpr kernels::panel_plan gaps(step({6, 5, 30}, extent2d(6, 5), 64, 32, 1, padding::valid));
    static_assert(!gaps.flat() && gaps.convolution.window.input == shape{6, 5, 30});
    constexpr kernels::panel_plan padded(step({14, 13, 96}, 1, 64, 96, 1, pad(1)));
    static_assert(!padded.flat() && padded.staged);
}

TEST_CASE("panel_plan: parts have all taps in the order of the weights, and rows a distance that does not "
          "clash") {
    for (const frame_convolution& c : {step({9, 9, 3}, 7, 64, 3, 2, pad(3)), step({9, 9, 200}, 3, 64, 200),
                                       step({9, 9, 30}, 3, 64, 32), step({9, 9, 1024}, 3, 64, 1024),
                                       step({4, 4, 2048}, 1, 64, 2048), step({9, 9, 512}, 3, 64, 512, 2)}) {
        const kernels::panel_plan plan(c);
        std::size_t taps = 0;
        plan.for_each_part([&](const kernels::panel_plan::part& part) {
            CHECK(part.first == taps);
            CHECK(part.first == (part.row * c.window.kernel.columns + part.column) * c.window.input.channels +
                                    part.channel);
            CHECK(part.lines * part.depth <= std::max(kernels::panel_plan::max_taps, plan.line_taps));
            taps += part.lines * part.depth;
        });
        CHECK(taps == c.taps());
        CHECK(plan.stride * c.window.stride.columns % kernels::panel_plan::clashing != 0);
    }
}

TEST_CASE("convolve_panels: single taps: one row of pixels, any number of channels") {
    support::compare_large(step({13, 11, 150}, 1, several_lanes, 150), 0, 1);
    support::compare_large(step({3, 5, 1024}, 1, several_lanes, 1024), 0, 2); // would clash
    support::compare_large(step({17, 16, 5}, 1, 7 * several_lanes, 16), 0, 3);
    support::compare_large(step({7, 9, 40}, 1, several_lanes + 1, 48, 2), 0, 4);
    support::compare_large(step({7, 9, 512}, 1, several_lanes, 512, 2), 0, 5);
    support::compare_large(step({7, 5, 20}, 1, 3 * several_lanes, 20, 1, pad(1, 0, 2, 1)), 0, 6);
}

TEST_CASE("convolve_panels: kernels, steps and paddings") {
    support::compare_large(step({31, 30, 3}, 7, several_lanes, 3, 2, pad(3)), 0, 1);
    support::compare_large(step({35, 37, 3}, 11, several_lanes + 3, 3, 4, pad(2)), 0, 2);
    support::compare_large(step({23, 21, 3}, 3, several_lanes, 3, 2, padding::valid), 0, 3);
    support::compare_large(step({7, 6, 70}, 3, 3 * several_lanes, 80, 2, pad(1)), 0, 4);
    // Bands of a row; as many filters make tiles worth it where vectors hold one number.
    support::compare_large(step({3, 300, 9}, 3, several_lanes, 9), several_lanes > 2 ? 0 : 4, 5);
    support::compare_large(step({9, 8, 130}, extent2d(5, 2), several_lanes, 130), 0, 6);
    support::compare_large(step({2, 2, 33}, 5, several_lanes, 33), 0, 7);
    support::compare_large(step({6, 5, 30}, extent2d(6, 5), 2 * several_lanes, 32, 1, padding::valid), 0, 8);
    support::compare_large(step({6, 5, 30}, extent2d(6, 5), 5 * several_lanes, 30, 1, padding::valid), 0, 9);
    // One row, which multiplies several panels together, and a rest.
    support::compare_large(step({6, 5, 30}, extent2d(6, 5), 20 * several_lanes, 30, 1, padding::valid), 0,
                           10);
}

TEST_CASE("convolve_panels: sums and ReLU") {
    for (const bool relu : {false, true}) {
        frame_convolution c = step({9, 11, 140}, 1, several_lanes, 140);
        c.accumulates = true, c.relu = relu;
        support::compare_large(c, 0, 1);
        c = step({9, 11, 60}, 5, 2 * several_lanes, 64);
        c.accumulates = true, c.relu = relu;
        support::compare_large(c, 0, 2);
    }
}
