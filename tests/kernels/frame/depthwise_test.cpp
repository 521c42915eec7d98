#include <tactnet/kernels/frame/methods.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/window_of.hpp>
#include <type_traits>
#include <utility>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

constexpr frame_convolution step(shape in, extent2d kernel, std::size_t filters_per_channel,
                                 std::size_t input_stride, extent2d stride = 1,
                                 padding around = padding::same) {
    return {.window = sliding_window::over(in, kernel, stride, around),
            .filters = filters_per_channel * in.channels,
            .input_stride = input_stride,
            .groups = in.channels};
}
constexpr frame_convolution with_relu(frame_convolution c) {
    c.relu = true;
    return c;
}
constexpr frame_convolution adding(frame_convolution c) {
    c.accumulates = true;
    return c;
}
constexpr frame_convolution pooled(frame_convolution c, extent2d pool) {
    c.pool = pool, c.relu = true;
    c.pooled_rows = (c.window.output_rows() + pool.rows - 1) / pool.rows;
    c.pooled_columns = (c.window.output_columns() + pool.columns - 1) / pool.columns;
    return c;
}

/// Runs the method on random numbers and holds every output to the bound of its error, channel by channel.
/// Lanes after the channels hold numbers, as other steps may leave them; NaN lies around all maps.
template <frame_convolution C>
void compare(std::uint64_t seed) {
    CAPTURE(seed);
    using method = depthwise_method<C>;
    // Without vectors, groups one by one need no copy.
    static_assert(std::is_same_v<convolution_method<C>, method> || (method::copied && C.separable_groups()));
    constexpr std::size_t channels = C.groups, area = C.window.input.area(), taps = C.window.kernel.area(),
                          output_area = C.output_rows() * C.output_columns();
    std::uint64_t state = seed;
    std::vector<float> weights(C.filters * taps), biases(C.filters);
    for (float& w : weights)
        w = support::draw(state);
    for (float& b : biases)
        b = support::draw(state);
    support::guarded_map input(area * C.input_stride, NAN, 1e3f),
        output(output_area * C.output_stride(), 12345, C.accumulates ? 0.0f : NAN),
        packed(method::packed_elements, 4321, 0), workspace(method::workspace_elements, 54321, NAN);
    for (std::size_t p = 0; p < area; ++p)
        for (std::size_t c = 0; c < channels; ++c)
            input.data()[p * C.input_stride + c] = support::draw(state);
    std::vector<float> added(output_area * C.filters);
    for (std::size_t i = 0; C.accumulates && i < added.size(); ++i)
        output.data()[i / C.filters * C.output_stride() + i % C.filters] = added[i] = support::draw(state);
    method::pack(
        [&](std::size_t f, std::size_t channel, std::size_t row, std::size_t column) {
            CHECK(channel == 0);
            return weights[f * taps + row * C.window.kernel.columns + column];
        },
        biases.data(), packed.data());
    method::run(packed.data(), input.data(), output.data(), workspace.data());
    CHECK(packed.untouched());
    CHECK(workspace.untouched());
    CHECK(output.untouched());

    support::sample in(channels * area), sums(C.filters * output_area), exact_biases(C.filters);
    for (std::size_t i = 0; i < in.size(); ++i)
        in[i].value = static_cast<double>(input.data()[i % area * C.input_stride + i / area]);
    for (std::size_t i = 0; C.accumulates && i < sums.size(); ++i)
        sums[i].value = static_cast<double>(added[i % output_area * C.filters + i / output_area]);
    for (std::size_t f = 0; f < C.filters; ++f)
        exact_biases[f].value = static_cast<double>(biases[f]);
    const std::vector<double> exact_weights(weights.begin(), weights.end());
    const support::sample expected = support::pooled_and_rectified(
        C, support::bounded_convolution(support::window_of(C.window), C.filters, exact_weights, exact_biases,
                                        in, C.accumulates ? &sums : nullptr, {}, channels));
    REQUIRE(expected.size() == C.filters * output_area);
    CHECK(support::outputs_outside(expected, output_area, output.data(), C.output_stride()) == 0);
}

} // namespace

TEST_CASE("depthwise_method: any number of channels, kernels and strides") {
    compare<step({14, 25, 64}, 3, 1, 64)>(1);
    compare<with_relu(step({7, 13, 6}, 3, 1, 16))>(2);
    compare<step({5, 4, 3}, extent2d(3, 5), 1, 16)>(3);
    compare<with_relu(step({9, 11, 33}, 3, 1, 48, 2))>(4);
    compare<step({9, 10, 20}, extent2d(4, 1), 1, 32, extent2d(1, 3))>(5);
    compare<step({6, 6, 17}, 3, 1, 32, 1, padding::valid)>(6);
    compare<step({1, 2, 8}, 5, 1, 8)>(7);
    compare<step({40, 50, 40}, 3, 1, 48)>(8);
    compare<step({9, 30, 16}, 7, 1, 16, 1, pad(3, 0, 2, 1))>(9);
}

TEST_CASE("depthwise_method: pools, and sums") {
    compare<pooled(step({7, 13, 24}, 3, 1, 32), 2)>(1);
    compare<pooled(step({8, 9, 5}, 3, 1, 16), extent2d(3, 2))>(2);
    compare<pooled(step({11, 9, 8}, 3, 1, 8, 2), extent2d(2, 3))>(5);
    compare<pooled(step({13, 9, 20}, extent2d(5, 2), 1, 32, extent2d(1, 2)), 2)>(6);
    compare<adding(step({7, 13, 24}, 3, 1, 32))>(3);
    compare<adding(step({9, 7, 8}, extent2d(2, 3), 1, 8, extent2d(3, 2)))>(7);
    compare<with_relu(adding(step({5, 4, 9}, 3, 1, 16)))>(4);
}

TEST_CASE("depthwise_method: pixels without gaps and several filters per channel are copied first") {
    compare<step({5, 7, 7}, 3, 1, 7)>(1);
    compare<step({5, 7, 13}, 3, 2, 16)>(2);
    compare<pooled(step({6, 8, 10}, 3, 3, 10), 2)>(3);
    compare<step({5, 7, 3}, 3, 5, 3, 2)>(4);
}

TEST_CASE("depthwise_method: as many weights as taps, one multiply-add for each") {
    constexpr frame_convolution c = step({14, 25, 64}, 3, 1, 64);
    CHECK(convolution_method<c>::packed_elements == 9 * 64 + 64);
    CHECK(convolution_method<c>::workspace_elements == 0);
    // 3 × 3 taps of 14 × 25 pixels, without those on padding.
    CHECK(convolution_method<c>::cost == 20 * (3 * 14 - 2) * (3 * 25 - 2) * c.vectors());
}
