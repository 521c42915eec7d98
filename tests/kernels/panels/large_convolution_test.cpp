#include <tactnet/kernels/panels/large_convolution.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <kernels/panels/comparison.hpp>
#include <span>
#include <support/same_bits.hpp>
#include <vector>

using namespace tactnet;
using kernels::frame_convolution;
using support::several_lanes;

namespace {

constexpr frame_convolution step(shape in, extent2d kernel, std::size_t filters, extent2d stride = 1,
                                 padding around = padding::same) {
    return {.window = sliding_window::over(in, kernel, stride, around),
            .filters = filters,
            .input_stride = in.channels,
            .relu = true};
}

} // namespace

TEST_CASE("panel_method: applicable from 40 000 elements of both maps on, or 256 thousand weights") {
    using kernels::panel_method;
    CHECK(panel_method<step({13, 13, 48}, 1, 192)>::applicable);
    CHECK(panel_method<step({4, 4, 512}, 3, 512)>::applicable);
    CHECK_FALSE(panel_method<step({10, 18, 64}, 2, 128)>::applicable);
    CHECK_FALSE(panel_method<step({6, 12, 128}, 3, 128)>::applicable);
    // Not for filters that do not fill a vector, whatever the map.
    if constexpr (kernels::lanes < float >> kernels::min_lanes<float>)
        CHECK_FALSE(panel_method<step({200, 200, 3}, 3, kernels::min_lanes<float>)>::applicable);
}

TEST_CASE("convolve_large: frames and threads leave the same bits as one frame on one thread") {
    const frame_convolution kinds[] = {
        step({7, 7, several_lanes}, 3, 5 * several_lanes),        // tiles of two, shared by filters
        step({26, 25, several_lanes}, 3, several_lanes),          // tiles of four, shared by tiles
        step({9, 9, 4 * several_lanes}, 1, 8 * several_lanes),    // a row of pixels
        step({5, 5, 1024}, 1, several_lanes),                     // the same, copied
        step({17, 15, 3}, 7, several_lanes, 2),                   // rows
        step({7, 7, 3 * several_lanes}, 3, 5 * several_lanes, 2), // rows, shared by filters
        step({4, 3, 8 * several_lanes}, extent2d(4, 3), 6 * several_lanes, 1, padding::valid)};
    for (const frame_convolution& c : kinds) {
        CAPTURE(c.window.input.rows);
        CAPTURE(c.window.kernel.rows);
        // Of single pixels more than a register block has rows.
        const std::size_t frames = c.window.kernel == extent2d(4, 3) ? 17 : 3;
        support::large_numbers all(c, frames, 7);
        const std::vector<float> together = all.run(1);
        for (std::size_t frame = 0; frame < frames; ++frame) {
            CHECK(all.wrong_outputs(frame, together.data()) == 0);
            support::large_numbers alone(c, 1, 8);
            std::copy_n(all.laid_inputs.data() + frame * all.input_distance, all.input_distance,
                        alone.laid_inputs.data());
            alone.weights = all.weights, alone.biases = all.biases;
            const std::vector<float> one = alone.run(1);
            const std::size_t size = c.output_rows() * c.output_columns() * c.output_stride();
            CHECK(support::numbers_that_differ(
                      std::span(one).first(size),
                      std::span(together).subspan(frame * all.output_distance, size)) == 0);
        }
        for (const std::size_t threads : {2U, 3U, 5U, 64U})
            for (const std::size_t workspaces : {1U, 3U})
                CHECK(support::numbers_that_differ(all.run(threads, workspaces), together) == 0);
    }
}

TEST_CASE("panel_plan: the weights of a dense layer pass once for all frames") {
    const kernels::panel_plan fc6(step({6, 6, 256}, 6, 4096, 1, padding::valid));
    REQUIRE(fc6.flat());
    CHECK(fc6.band_columns == 1);
    for (const std::size_t frames : {2U, 16U, 56U})
        CHECK(fc6.side_by_side(frames).band_columns == frames);
    // More would not stay near: bands of nearly the same size.
    CHECK(fc6.side_by_side(57).band_columns == 29);

    const kernels::panel_plan pixels(step({7, 7, 512}, 1, 2048));
    CHECK(pixels.band_columns == 49);
    CHECK(pixels.side_by_side(16).band_columns == 112);
    CHECK(pixels.side_by_side(1).band_columns == 49);
}
