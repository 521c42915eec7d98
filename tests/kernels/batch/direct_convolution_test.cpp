#include <tactnet/kernels/batch/direct_convolution.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

// The geometry alone, with whole numbers: nothing is rounded. What layers make of it is checked in layers/.

namespace {

constexpr sliding_window window = sliding_window::over({5, 7, 2}, {3, 2}, {2, 3}, pad(1, 2, 0, 1));
constexpr std::size_t filters = 9; // one more than a register block
constexpr batch_convolution ahead = batch_convolution::forward(window, filters),
                            back = batch_convolution::backward(window, filters);

static_assert(ahead.output == shape{window.output_rows(), window.output_columns(), filters});
static_assert(ahead.spacing == extent2d{1} && ahead.stride == window.stride && ahead.top == 1 &&
              ahead.left == 0);
// Backwards the stride becomes the distance between pixels, and padding what the kernel reaches beyond it.
static_assert(back.spacing == window.stride && back.stride == extent2d{1} && back.top == 1 && back.left == 1);
static_assert(back.input == ahead.output && back.output == ahead.input);

int weight(std::size_t filter, std::size_t channel, std::size_t row, std::size_t column) {
    return static_cast<int>((filter * 31 + channel * 17 + row * 5 + column * 3) % 11) - 5;
}
template <class T>
aligned_vector<T> numbers(std::size_t size) {
    aligned_vector<T> v(size);
    for (std::size_t i = 0; i < size; ++i)
        v[i] = static_cast<T>(static_cast<int>(i * 7919 % 13) - 6);
    return v;
}
/// body(output pixel, input pixel, row, column)
template <class Body>
void for_each_tap(Body&& body) {
    for (std::size_t y = 0; y < window.output_rows(); ++y)
        for (std::size_t x = 0; x < window.output_columns(); ++x)
            for (std::size_t i = 0; i < window.kernel.rows; ++i)
                for (std::size_t j = 0; j < window.kernel.columns; ++j) {
                    const auto row =
                        static_cast<int>(y * window.stride.rows + i) - static_cast<int>(window.top);
                    const auto column =
                        static_cast<int>(x * window.stride.columns + j) - static_cast<int>(window.left);
                    if (row >= 0 && row < 5 && column >= 0 && column < 7)
                        body(y * window.output_columns() + x, static_cast<std::size_t>(row * 7 + column), i,
                             j);
                }
}

} // namespace

TEST_CASE_TEMPLATE("direct_lane_method: forward", T, float, double) {
    constexpr std::size_t width = lanes<T>, area = window.output_rows() * window.output_columns();
    const aligned_vector<T> in = numbers<T>(window.input.size() * width);
    aligned_vector<T> packed(filters * 2 * window.kernel.area()), out(filters * area * width, T{99}),
        bias(filters);
    for (std::size_t f = 0; f < filters; ++f)
        bias[f] = static_cast<T>(f);
    direct_lane_method<ahead, T>::pack(
        [](auto f, auto c, auto i, auto j) { return static_cast<T>(weight(f, c, i, j)); }, packed.data());
    direct_lane_method<ahead, T>::run(packed.data(), bias.data(), in.data(), out.data(), nullptr);

    std::vector<T> expected(filters * area * width);
    for (std::size_t f = 0; f < filters; ++f)
        for (std::size_t lane = 0; lane < width; ++lane) {
            for (std::size_t o = 0; o < area; ++o)
                expected[(f * area + o) * width + lane] = bias[f];
            for (std::size_t c = 0; c < 2; ++c)
                for_each_tap([&](std::size_t o, std::size_t pixel, std::size_t i, std::size_t j) {
                    expected[(f * area + o) * width + lane] +=
                        static_cast<T>(weight(f, c, i, j)) * in[(c * 35 + pixel) * width + lane];
                });
        }
    CHECK(std::vector<T>(out.begin(), out.end()) == expected);
}

TEST_CASE_TEMPLATE("direct_lane_method: backward reads as if zeros stood between the gradient's pixels", T,
                   float, double) {
    constexpr std::size_t width = lanes<T>, area = window.output_rows() * window.output_columns();
    const aligned_vector<T> gradient = numbers<T>(filters * area * width);
    aligned_vector<T> packed(filters * 2 * window.kernel.area()), out(window.input.size() * width, T{99});
    direct_lane_method<back, T>::pack(
        [](auto c, auto f, auto i, auto j) {
            return static_cast<T>(weight(f, c, window.kernel.rows - 1 - i, window.kernel.columns - 1 - j));
        },
        packed.data());
    direct_lane_method<back, T>::run(packed.data(), nullptr, gradient.data(), out.data(), nullptr);

    std::vector<T> expected(window.input.size() * width);
    for (std::size_t f = 0; f < filters; ++f)
        for (std::size_t c = 0; c < 2; ++c)
            for (std::size_t lane = 0; lane < width; ++lane)
                for_each_tap([&](std::size_t o, std::size_t pixel, std::size_t i, std::size_t j) {
                    expected[(c * 35 + pixel) * width + lane] +=
                        static_cast<T>(weight(f, c, i, j)) * gradient[(f * area + o) * width + lane];
                });
    CHECK(std::vector<T>(out.begin(), out.end()) == expected);
}
