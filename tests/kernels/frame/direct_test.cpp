#include <tactnet/kernels/frame/direct.hpp>
#include <tactnet/kernels/frame/winograd.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/window_of.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// Runs one fused step on random numbers and holds every output to the bound of its error.
template <frame_convolution C, extent2d Tile>
void compare(std::uint64_t seed) {
    CAPTURE(C.window.input.rows);
    CAPTURE(C.window.input.columns);
    CAPTURE(C.window.input.channels);
    CAPTURE(C.filters);
    CAPTURE(Tile.rows);
    CAPTURE(Tile.columns);
    constexpr std::size_t channels = C.window.input.channels, area = C.window.input.area();
    constexpr std::size_t taps = C.window.kernel.area();
    std::uint64_t state = seed;
    std::vector<double> weights(C.filters * channels * taps);
    for (double& w : weights)
        w = static_cast<double>(support::draw(state));
    std::vector<support::bounded> biases(C.filters);
    for (support::bounded& b : biases)
        b.value = static_cast<double>(support::draw(state));
    support::sample in(channels * area);
    for (support::bounded& x : in)
        x.value = static_cast<double>(support::draw(state));

    // Lanes beyond the channels hold numbers, as other steps may leave them; around the map is NaN.
    support::guarded_map input(area * C.input_stride, NAN, 1e3f);
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t p = 0; p < area; ++p)
            input.data()[p * C.input_stride + c] = static_cast<float>(in[c * area + p].value);
    constexpr std::size_t output_area = C.output_rows() * C.output_columns();
    support::guarded_map output(output_area * C.output_stride(), 12345, C.accumulates ? 0.0f : NAN);
    support::sample added(C.filters * output_area);
    for (std::size_t f = 0; f < C.filters && C.accumulates; ++f)
        for (std::size_t p = 0; p < output_area; ++p) {
            added[f * output_area + p].value = static_cast<double>(support::draw(state));
            output.data()[p * C.output_stride() + f] = static_cast<float>(added[f * output_area + p].value);
        }

    const auto weight = [&](std::size_t f, std::size_t c, std::size_t row, std::size_t column) {
        return static_cast<float>(
            weights[((f * channels + c) * C.window.kernel.rows + row) * C.window.kernel.columns + column]);
    };
    std::vector<float> bias;
    for (const support::bounded& b : biases)
        bias.push_back(static_cast<float>(b.value));
    using method = std::conditional_t<Tile == extent2d(0), direct_method<C>, winograd_method<C, Tile>>;
    static_assert(method::applicable && method::tile == Tile);
    support::guarded_map packed(method::packed_elements, 4321, 0),
        workspace(method::workspace_elements, 54321, NAN);
    method::pack(weight, bias.data(), packed.data());
    method::run(packed.data(), input.data(), output.data(), workspace.data());
    CHECK(packed.untouched());
    CHECK(workspace.untouched());
    CHECK(output.untouched());

    const support::sample expected = support::pooled_and_rectified(
        C, support::bounded_convolution(support::window_of(C.window), C.filters, weights, biases, in,
                                        C.accumulates ? &added : nullptr, {Tile.rows, Tile.columns}));
    REQUIRE(expected.size() == C.filters * output_area);
    CHECK(support::outputs_outside(expected, output_area, output.data(), C.output_stride()) == 0);
}

constexpr frame_convolution step(shape in, extent2d kernel, std::size_t filters, std::size_t input_stride,
                                 extent2d stride = 1, padding around = padding::same) {
    return {.window = sliding_window::over(in, kernel, stride, around),
            .filters = filters,
            .input_stride = input_stride};
}
/// Behind it a max pool of windows side by side; `whole` leaves out windows that the image does not fill.
constexpr frame_convolution pooled(frame_convolution c, extent2d pool, bool whole = false) {
    const std::size_t rows = c.window.output_rows(), columns = c.window.output_columns();
    c.pool = pool, c.relu = true;
    c.pooled_rows = whole ? rows / pool.rows : (rows + pool.rows - 1) / pool.rows;
    c.pooled_columns = whole ? columns / pool.columns : (columns + pool.columns - 1) / pool.columns;
    return c;
}
constexpr frame_convolution adding(frame_convolution c, bool relu) {
    c.accumulates = true, c.relu = relu;
    return c;
}

template <frame_convolution C, extent2d Tile = 0>
struct job {
    static void run(std::uint64_t seed) { compare<C, Tile>(seed); }
};
template <class... Jobs>
void run_all() {
    std::uint64_t seed = 1;
    (Jobs::run(++seed), ...);
}

} // namespace

TEST_CASE("direct_method: sizes, strides and paddings") {
    run_all<job<step({28, 50}, 5, 8, 1)>,                                    //
            job<step({1, 1}, 3, 1, 1)>,                                      //
            job<step({1, 9, 3}, 3, 5, 3)>,                                   //
            job<step({11, 1, 2}, 2, 12, 16)>,                                //
            job<step({5, 7, 3}, extent2d(4, 2), 20, 8)>,                     //
            job<step({9, 8, 2}, 3, 33, 2, 2)>,                               //
            job<step({10, 13}, 5, 3, 1, 2, pad(2))>,                         //
            job<step({6, 7, 5}, extent2d(2, 3), 16, 8, 1, padding::valid)>,  //
            job<step({6, 5, 4}, 3, 40, 4, extent2d(1, 2), pad(0, 2, 1, 0))>, //
            job<step({4, 5, 16}, 1, 64, 16)>>();
}

TEST_CASE("direct_method: pools, ReLU and sums") {
    run_all<job<pooled(step({7, 13}, 5, 8, 1), 2)>,                       //
            job<pooled(step({7, 13, 2}, 3, 12, 16), 2, true)>,            //
            job<pooled(step({8, 11, 3}, 3, 5, 3), extent2d(3, 2))>,       //
            job<pooled(step({5, 9, 2}, 2, 33, 2), extent2d(1, 3), true)>, //
            job<adding(step({5, 6, 12}, 3, 20, 16), true)>,               //
            job<adding(step({3, 9, 4}, 1, 3, 4, 2), false)>>();
}

TEST_CASE("winograd_method: 3 x 3 and 2 x 2 kernels, odd sizes, paddings") {
    run_all<job<step({14, 25, 8}, 3, 16, 8), 2>,                    //
            job<step({7, 13, 16}, 2, 32, 16), 2>,                   //
            job<step({1, 1, 4}, 3, 4, 4), 2>,                       //
            job<step({5, 1, 20}, 3, 5, 32), 2>,                     //
            job<step({1, 6, 3}, 2, 1, 16), 2>,                      //
            job<step({9, 5, 12}, 3, 40, 16, 1, padding::valid), 2>, //
            job<step({6, 7, 5}, 2, 33, 16, 1, pad(1)), 2>,          //
            job<step({6, 7, 4}, 3, 12, 4, 1, pad(2, 0, 1, 2)), 2>>();
}

TEST_CASE("winograd_method: pools, ReLU and sums") {
    run_all<job<pooled(step({7, 13, 16}, 3, 32, 16), 2), 2>,    //
            job<pooled(step({7, 13, 8}, 3, 5, 8), 2, true), 2>, //
            job<pooled(step({5, 9, 12}, 2, 20, 16), 2), 2>,     //
            job<adding(step({7, 9, 20}, 3, 20, 32), true), 2>,  //
            job<adding(step({4, 5, 4}, 2, 12, 4), false), 2>>();
}

TEST_CASE("winograd_method: larger ones, and those that are no squares") {
    run_all<job<step({6, 9, 8}, 3, 20, 8), extent2d(2, 4)>,                   //
            job<step({6, 9, 8}, 3, 20, 8), extent2d(3, 4)>,                   //
            job<step({7, 3, 8}, 3, 8, 8), extent2d(4, 3)>,                    //
            job<step({11, 7, 8}, 2, 36, 8), extent2d(5, 3)>,                  //
            job<step({4, 9, 8}, 2, 8, 8), extent2d(4, 5)>,                    //
            job<step({1, 2, 4}, 3, 4, 4, 1, pad(0, 2, 1, 2)), extent2d(4)>,   //
            job<pooled(step({7, 10, 5}, 3, 8, 16), 2), extent2d(4)>,          //
            job<pooled(step({7, 13, 5}, 2, 8, 16), 2, true), extent2d(2, 4)>, //
            job<adding(step({3, 5, 12}, 3, 64, 16), true), extent2d(3)>>();
}
