#include <tactnet/kernels/panels/convolution.hpp>
#include <tactnet/kernels/panels/large_convolution.hpp>
#include <tactnet/kernels/panels/tiles.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <support/frame_convolution.hpp>
#include <support/same_bits.hpp>
#include <vector>

using namespace tactnet;
using kernels::frame_convolution;
using support::adding;
using support::pooled;
using support::step;

// Large convolutions of one frame or several on random numbers, held to the bound of their errors.

namespace {

/// Sizes that come in whole vectors whatever the instruction set.
constexpr std::size_t several_lanes = 2 * kernels::lanes<float>;

/// Output maps as all shares of `threads` leave them, one after the other.
std::vector<float> run_large(support::convolution_numbers& numbers, std::size_t threads,
                             std::size_t workspaces = 1) {
    const kernels::large_convolution plan(numbers.c);
    support::guarded_map packed(plan.weights(), 4321, 0), memory(workspaces * plan.workspace(), 54321, NAN),
        bias(numbers.c.padded_filters(), NAN, 0), output = numbers.fresh_outputs();
    std::copy(numbers.bias.begin(), numbers.bias.end(), bias.data());
    plan.pack(numbers.weight(), packed.data());
    for (std::size_t thread = 0; thread < threads; ++thread)
        convolve_large(
            plan,
            {numbers.frames, numbers.input_distance, numbers.output_distance, {thread, threads}, workspaces},
            numbers.laid_inputs.data(), packed.data(), bias.data(), output.data(), memory.data());
    CHECK(packed.untouched());
    CHECK(memory.untouched());
    CHECK(output.untouched());
    return {output.data(),
            output.data() + (numbers.frames - 1) * numbers.output_distance + numbers.output_size()};
}
std::size_t wrong_outputs_of_large(const support::convolution_numbers& numbers, std::size_t frame,
                                   const float* found) {
    return numbers.wrong_outputs(frame, found, kernels::large_convolution(numbers.c).tiles.outputs);
}

/// One frame, held to the bound.
void compare_large(const frame_convolution& c, std::size_t tile_outputs, std::uint64_t seed) {
    CAPTURE(c.window.input.rows);
    CAPTURE(c.window.input.columns);
    CAPTURE(c.window.input.channels);
    CAPTURE(c.filters);
    REQUIRE(kernels::large_convolution::fits(c));
    CHECK(kernels::large_convolution(c).tiles.outputs == tile_outputs);
    support::convolution_numbers numbers(c, 1, seed);
    CHECK(wrong_outputs_of_large(numbers, 0, run_large(numbers, 1).data()) == 0);
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
    compare_large(step({13, 11, 150}, 1, several_lanes, 150), 0, 1);
    compare_large(step({3, 5, 1024}, 1, several_lanes, 1024), 0, 2); // would clash
    compare_large(step({17, 16, 5}, 1, 7 * several_lanes, 16), 0, 3);
    compare_large(step({7, 9, 40}, 1, several_lanes + 1, 48, 2), 0, 4);
    compare_large(step({7, 9, 512}, 1, several_lanes, 512, 2), 0, 5);
    compare_large(step({7, 5, 20}, 1, 3 * several_lanes, 20, 1, pad(1, 0, 2, 1)), 0, 6);
}

TEST_CASE("convolve_panels: kernels, steps and paddings") {
    compare_large(step({31, 30, 3}, 7, several_lanes, 3, 2, pad(3)), 0, 1);
    compare_large(step({35, 37, 3}, 11, several_lanes + 3, 3, 4, pad(2)), 0, 2);
    compare_large(step({23, 21, 3}, 3, several_lanes, 3, 2, padding::valid), 0, 3);
    compare_large(step({7, 6, 70}, 3, 3 * several_lanes, 80, 2, pad(1)), 0, 4);
    // Bands of a row; as many filters make tiles worth it where vectors hold one number.
    compare_large(step({3, 300, 9}, 3, several_lanes, 9), several_lanes > 2 ? 0 : 4, 5);
    compare_large(step({9, 8, 130}, extent2d(5, 2), several_lanes, 130), 0, 6);
    compare_large(step({2, 2, 33}, 5, several_lanes, 33), 0, 7);
    compare_large(step({6, 5, 30}, extent2d(6, 5), 2 * several_lanes, 32, 1, padding::valid), 0, 8);
    compare_large(step({6, 5, 30}, extent2d(6, 5), 5 * several_lanes, 30, 1, padding::valid), 0, 9);
    // One row, which multiplies several panels together, and a rest.
    compare_large(step({6, 5, 30}, extent2d(6, 5), 20 * several_lanes, 30, 1, padding::valid), 0, 10);
}

TEST_CASE("convolve_panels: sums and ReLU") {
    for (const bool relu : {false, true}) {
        compare_large(adding(step({9, 11, 140}, 1, several_lanes, 140), relu), 0, 1);
        compare_large(adding(step({9, 11, 60}, 5, 2 * several_lanes, 64), relu), 0, 2);
    }
}

namespace {

frame_convolution three_by_three(shape in, std::size_t filters, padding around = padding::same,
                                 std::size_t input_stride = 0) {
    return step(in, 3, filters, input_stride > 0 ? input_stride : in.channels, 1, around);
}

} // namespace

TEST_CASE("tile_plan: tiles of four where they save a third and meet their weights, else of two, else taps") {
    const auto outputs = [](shape in) {
        return kernels::tile_plan(three_by_three(in, several_lanes)).outputs;
    };
    CHECK(outputs({56, 56, several_lanes}) == 4);
    CHECK(outputs({28, 28, several_lanes}) == 4);
    CHECK(outputs({14, 14, several_lanes}) == 2);
    CHECK(outputs({7, 7, several_lanes}) == 2);
    CHECK(outputs({4, 4, several_lanes}) == 0);
}

TEST_CASE("convolve_tiles: outputs of two and of four a side, odd sizes and paddings") {
    compare_large(three_by_three({7, 7, several_lanes}, several_lanes), 2, 1);
    compare_large(three_by_three({13, 14, several_lanes}, several_lanes + 1), 2, 2);
    compare_large(three_by_three({28, 24, several_lanes}, several_lanes), 4, 3);
    compare_large(three_by_three({25, 31, several_lanes}, 3 * several_lanes, pad(1, 0, 2, 1)), 4, 4);
    compare_large(three_by_three({26, 26, several_lanes}, several_lanes, padding::valid, 2 * several_lanes),
                  4, 5);
    compare_large(three_by_three({8, 8, 512}, several_lanes), 2, 6); // channels that would clash
}

TEST_CASE("convolve_tiles: pools, sums and ReLU") {
    compare_large(pooled(three_by_three({13, 14, several_lanes}, several_lanes), 2), 2, 1);
    compare_large(pooled(three_by_three({15, 15, several_lanes}, several_lanes), 2, true), 2, 1);
    for (const bool whole : {false, true})
        compare_large(pooled(three_by_three({27, 29, several_lanes}, several_lanes), 2, whole), 4, 2);
    for (frame_convolution c : {three_by_three({9, 14, several_lanes}, several_lanes),
                                three_by_three({24, 27, several_lanes}, several_lanes)}) {
        c.accumulates = true;
        const std::size_t outputs = kernels::tile_plan(c).outputs;
        CHECK(outputs > 0);
        compare_large(c, outputs, 3);
        c.activation = fused<relu_function>;
        compare_large(c, outputs, 4);
    }
}

namespace {

/// Pixels side by side, and a ReLU.
constexpr frame_convolution dense_step(shape in, extent2d kernel, std::size_t filters, extent2d stride = 1,
                                       padding around = padding::same) {
    return support::with_relu(step(in, kernel, filters, in.channels, stride, around));
}

} // namespace

TEST_CASE("panel_method: applicable from 40 000 elements of both maps on, or 256 thousand weights") {
    using kernels::panel_method;
    CHECK(panel_method<dense_step({13, 13, 48}, 1, 192)>::applicable);
    CHECK(panel_method<dense_step({4, 4, 512}, 3, 512)>::applicable);
    CHECK_FALSE(panel_method<dense_step({10, 18, 64}, 2, 128)>::applicable);
    CHECK_FALSE(panel_method<dense_step({6, 12, 128}, 3, 128)>::applicable);
    // Tiles of few channels and filters are left to the Winograd kernel of a frame.
    CHECK_FALSE(panel_method<dense_step({28, 50, 32}, 3, 32)>::applicable);
    CHECK(panel_method<dense_step({28, 50, 32}, 3, 64)>::applicable);
    CHECK(panel_method<dense_step({28, 50, 64}, 3, 32)>::applicable);
    CHECK(panel_method<dense_step({28, 50, 32}, 5, 32)>::applicable);
    // Not for filters that do not fill a vector, whatever the map.
    if constexpr (kernels::lanes < float >> kernels::min_lanes<float>)
        CHECK_FALSE(panel_method<dense_step({200, 200, 3}, 3, kernels::min_lanes<float>)>::applicable);
}

TEST_CASE("convolve_large: frames and threads leave the same bits as one frame on one thread") {
    const frame_convolution kinds[] = {
        dense_step({7, 7, several_lanes}, 3, 5 * several_lanes),        // tiles of two, shared by filters
        dense_step({26, 25, several_lanes}, 3, several_lanes),          // tiles of four, shared by tiles
        dense_step({9, 9, 4 * several_lanes}, 1, 8 * several_lanes),    // a row of pixels
        dense_step({5, 5, 1024}, 1, several_lanes),                     // the same, copied
        dense_step({17, 15, 3}, 7, several_lanes, 2),                   // rows
        dense_step({7, 7, 3 * several_lanes}, 3, 5 * several_lanes, 2), // rows, shared by filters
        dense_step({4, 3, 8 * several_lanes}, extent2d(4, 3), 6 * several_lanes, 1, padding::valid)};
    for (const frame_convolution& c : kinds) {
        CAPTURE(c.window.input.rows);
        CAPTURE(c.window.kernel.rows);
        // Of single pixels more than a register block has rows.
        const std::size_t frames = c.window.kernel == extent2d(4, 3) ? 17 : 3;
        support::convolution_numbers all(c, frames, 7);
        const std::vector<float> together = run_large(all, 1);
        for (std::size_t frame = 0; frame < frames; ++frame) {
            CHECK(wrong_outputs_of_large(all, frame, together.data()) == 0);
            support::convolution_numbers alone(c, 1, 8);
            std::copy_n(all.laid_inputs.data() + frame * all.input_distance, all.input_size(),
                        alone.laid_inputs.data());
            alone.weights = all.weights, alone.bias = all.bias;
            const std::vector<float> one = run_large(alone, 1);
            const std::size_t size = c.output_rows() * c.output_columns() * c.output_stride();
            CHECK(support::numbers_that_differ(
                      std::span(one).first(size),
                      std::span(together).subspan(frame * all.output_distance, size)) == 0);
        }
        for (const std::size_t threads : {2U, 3U, 5U, 64U})
            for (const std::size_t workspaces : {1U, 3U})
                CHECK(support::numbers_that_differ(run_large(all, threads, workspaces), together) == 0);
    }
}

TEST_CASE("panel_plan: the weights of a dense layer pass once for all frames") {
    const kernels::panel_plan fc6(dense_step({6, 6, 256}, 6, 4096, 1, padding::valid));
    REQUIRE(fc6.flat());
    CHECK(fc6.band_columns == 1);
    for (const std::size_t frames : {2U, 16U, 56U})
        CHECK(fc6.side_by_side(frames).band_columns == frames);
    // More would not stay near: bands of nearly the same size.
    CHECK(fc6.side_by_side(57).band_columns == 29);

    const kernels::panel_plan pixels(dense_step({7, 7, 512}, 1, 2048));
    CHECK(pixels.band_columns == 49);
    CHECK(pixels.side_by_side(16).band_columns == 112);
    CHECK(pixels.side_by_side(1).band_columns == 49);
}
