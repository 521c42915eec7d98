#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/kernels/frame/pooling.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <support/layers/deployed_reference.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// A map [channel][pixel] of random numbers, and the same pixel by pixel with `stride` elements from one to
/// the next; lanes beyond the channels hold `rest`.
support::sample random_map(shape size, std::size_t stride, float rest, float* pixels, std::uint64_t& state) {
    support::sample map(size.size());
    std::fill_n(pixels, size.area() * stride, rest);
    for (std::size_t c = 0; c < size.channels; ++c)
        for (std::size_t p = 0; p < size.area(); ++p) {
            const float value = support::draw(state);
            map[c * size.area() + p].value = static_cast<double>(value);
            pixels[p * stride + c] = value;
        }
    return map;
}

/// Several frames at once give the same bits as each alone. NaN lies between their inputs.
template <frame_dense D, std::size_t Frames>
void check_several(const float* packed, std::uint64_t& state) {
    const float* const bias = packed + direct_dense_method<D>::packed_weights;
    constexpr std::size_t in_distance = D.inputs() + 3, out_distance = D.output_stride() + 16;
    std::vector<float> inputs(Frames * in_distance, NAN), expected;
    support::guarded_map outputs((Frames - 1) * out_distance + D.output_stride(), 12345, NAN),
        alone(D.output_stride(), 1234, NAN);
    for (std::size_t frame = 0; frame < Frames; ++frame) {
        float* const input = inputs.data() + frame * in_distance;
        for (std::size_t i = 0; i < D.inputs(); ++i)
            input[i] = support::draw(state);
        multiply_frames<D>(input, 0, packed, bias, alone.data(), 0);
        expected.insert(expected.end(), alone.data(), alone.data() + D.output_stride());
    }
    multiply_frames<D, Frames>(inputs.data(), in_distance, packed, bias, outputs.data(), out_distance);
    CHECK(outputs.untouched());
    std::size_t other = 0;
    for (std::size_t frame = 0; frame < Frames; ++frame)
        for (std::size_t o = 0; o < D.output_stride(); ++o)
            other += std::bit_cast<std::uint32_t>(outputs.data()[frame * out_distance + o]) !=
                     std::bit_cast<std::uint32_t>(expected[frame * D.output_stride() + o]);
    CHECK(other == 0);
}

template <frame_dense D>
void compare_dense() {
    CAPTURE(D.outputs);
    std::uint64_t state = D.outputs;
    support::guarded_map input(D.inputs(), NAN, 0), output(D.output_stride(), 12345, NAN),
        packed(direct_dense_method<D>::packed_elements, NAN, 0);
    const support::sample in = random_map(D.input, D.input_stride, 1e3f, input.data(), state);
    std::vector<double> weights(D.outputs * D.input.size());
    for (double& w : weights)
        w = static_cast<double>(support::draw(state));
    std::vector<support::bounded> biases(D.outputs);
    std::vector<float> bias(D.outputs);
    for (std::size_t o = 0; o < D.outputs; ++o)
        biases[o].value = static_cast<double>(bias[o] = support::draw(state));
    const auto weight = [&](std::size_t o, std::size_t channel, std::size_t pixel) {
        return static_cast<float>(weights[(o * D.input.channels + channel) * D.input.area() + pixel]);
    };
    direct_dense_method<D>::pack(weight, bias.data(), packed.data());
    direct_dense_method<D>::run(packed.data(), input.data(), output.data(), nullptr);
    CHECK(packed.untouched());
    CHECK(output.untouched());
    check_several<D, 2>(packed.data(), state);
    check_several<D, 3>(packed.data(), state);
    const support::sample expected = support::bounded_convolution(
        {{D.input.channels, D.input.rows, D.input.columns}, D.input.rows, D.input.columns, 1, 1, 0, 0, 0, 0},
        D.outputs, weights, biases, in, nullptr, {});
    REQUIRE(expected.size() == D.outputs);
    CHECK(support::outputs_outside(expected, 1, output.data(), D.output_stride()) == 0);
}

template <sliding_window W, std::size_t Stride>
void compare_pool() {
    std::uint64_t state = Stride;
    constexpr std::size_t area = W.output_rows() * W.output_columns();
    support::guarded_map input(W.input.area() * Stride, NAN, 0), output(area * Stride, 12345, NAN);
    // All below zero: padding that counted as zero would be the largest.
    support::sample in = random_map(W.input, Stride, -5, input.data(), state);
    for (std::size_t i = 0; i < W.input.area() * Stride; ++i)
        input.data()[i] -= 2;
    for (support::bounded& x : in)
        x.value = static_cast<double>(static_cast<float>(x.value) - 2);
    pool_frame<W, Stride>(input.data(), output.data());
    CHECK(output.untouched());
    const support::sample expected =
        support::bounded_max_pool({{W.input.channels, W.input.rows, W.input.columns},
                                   W.kernel.rows,
                                   W.kernel.columns,
                                   W.stride.rows,
                                   W.stride.columns,
                                   W.top,
                                   W.bottom,
                                   W.left,
                                   W.right},
                                  in);
    std::size_t wrong = 0;
    for (std::size_t c = 0; c < W.input.channels; ++c)
        for (std::size_t p = 0; p < area; ++p)
            wrong += static_cast<double>(output.data()[p * Stride + c]) != expected[c * area + p].value;
    CHECK(wrong == 0);
}

template <pooling_windows W, std::size_t Channels, std::size_t Stride>
void compare_average() {
    std::uint64_t state = Stride;
    constexpr shape size{W.rows.size, W.columns.size, Channels};
    constexpr std::size_t outputs = W.rows.outputs * W.columns.outputs;
    support::guarded_map input(size.area() * Stride, NAN, 0), output(outputs * Stride, 12345, NAN);
    const support::sample in = random_map(size, Stride, 0, input.data(), state);
    average_frame<W, Stride>(input.data(), output.data());
    CHECK(output.untouched());
    std::size_t wrong = 0;
    W.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
        const double share = 1 / static_cast<double>(divisor);
        // One rounding each for the additions, the reciprocal of the divisor and the product.
        const auto roundings =
            static_cast<double>((rows.end - rows.begin) * (columns.end - columns.begin) + 1);
        for (std::size_t c = 0; c < Channels; ++c) {
            support::bounded mean;
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x) {
                    const double value = in[c * size.area() + y * size.columns + x].value * share;
                    mean.value += value, mean.error += std::abs(value);
                }
            mean.error *= support::accumulated(support::deployed_roundoff, roundings);
            wrong += !support::within(static_cast<double>(output.data()[o * Stride + c]), mean);
        }
    });
    CHECK(wrong == 0);
}

} // namespace

TEST_CASE("dense: outputs and channels that fill vectors and that do not") {
    compare_dense<frame_dense{{4, 7, 32}, 32, 22}>();
    compare_dense<frame_dense{{1, 1, 3}, 4, 1}>();
    compare_dense<frame_dense{{3, 2, 5}, 8, 5}>();
    compare_dense<frame_dense{{2, 3, 2}, 2, 40}>();
    compare_dense<frame_dense{{1, 5, 12}, 16, 131}>();
}

TEST_CASE("pooling: windows that overlap, keep the image, or reach beyond it") {
    compare_pool<sliding_window::over({7, 9, 12}, 3, 2, padding::same), 16>();
    compare_pool<sliding_window::over({7, 9, 20}, 2, 1, padding::same), 32>();
    compare_pool<sliding_window::over({6, 5, 3}, 3, 1, pad(1)), 3>();
    compare_pool<sliding_window::over({8, 4, 5}, extent2d(4, 1), extent2d(3, 2), padding::valid), 8>();
    compare_pool<sliding_window::over({5, 6, 61}, 3, 1, pad(1)), 64>(); // several vectors side by side
    compare_pool<sliding_window::over({3, 2, 4}, 5, 1, pad(3)), 4>();   // every window is cut
    compare_pool<sliding_window::over({9, 12, 16}, extent2d(2, 9), extent2d(1, 2), pad(1)), 16>();
}

TEST_CASE("pooling: averages of windows that overlap, leave pixels out, or reach beyond the image") {
    const auto of = [](const sliding_window& window, bool counts_padding = false) {
        pooling_windows windows = windows_of(window);
        windows.counts_padding = counts_padding;
        return windows;
    };
    compare_average<of(sliding_window::over({7, 9, 1}, 3, 1, padding::same)), 12, 16>();
    compare_average<of(sliding_window::over({7, 9, 1}, 3, 1, pad(1)), true), 61, 64>();
    compare_average<of(sliding_window::over({6, 7, 1}, 2, 2, padding::same)), 3, 3>();
    compare_average<of(sliding_window::over({8, 9, 1}, extent2d(1, 2), extent2d(3, 4), padding::valid)), 8,
                    8>();
    compare_average<of(sliding_window::over({9, 11, 1}, 7, 2, pad(3)), true), 16, 16>();
    compare_average<of(sliding_window::over({9, 12, 1}, extent2d(2, 9), extent2d(1, 2), pad(1))), 16, 16>();
    compare_average<pooling_windows{{7, 2}, {9, 4}}, 4, 4>();
}
