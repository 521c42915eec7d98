#include <tactnet/kernels/batch/direct_convolution.hpp>
#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/kernels/batch/methods.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <support/guarded_map.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

// The geometry alone, with whole numbers: nothing is rounded. What layers make of it is checked in
// layers/.

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
aligned_vector<T> numbers_below_7(std::size_t size) {
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
    const aligned_vector<T> in = numbers_below_7<T>(window.input.size() * width);
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
    const aligned_vector<T> gradient = numbers_below_7<T>(filters * area * width);
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

namespace {

template <std::size_t Rows, std::size_t Columns, matrix_layout Layout, class T>
void check_product() {
    const aligned_vector<T> matrix = support::whole_numbers<T>(Rows * Columns, 7919),
                            values = support::whole_numbers<T>(Columns * lanes<T>, 104729);
    std::vector<int> puts(Rows);
    lane_product<Rows, Columns, Layout>(
        matrix.data(), values.data(), [&](std::size_t row, const vector<T>& sum) {
            REQUIRE(row < Rows);
            ++puts[row];
            aligned_vector<T> found(lanes<T>), expected(lanes<T>);
            store(found.data(), sum);
            for (std::size_t c = 0; c < Columns; ++c)
                for (std::size_t lane = 0; lane < lanes<T>; ++lane)
                    expected[lane] +=
                        matrix[row * Layout.row + c * Layout.column] * values[c * lanes<T> + lane];
            CHECK(found == expected);
        });
    CHECK(std::all_of(puts.begin(), puts.end(), [](int n) { return n == 1; }));
}

} // namespace

TEST_CASE_TEMPLATE("lane_product: against plain loops, the matrix as it is and transposed", T, float,
                   double) {
    check_product<1, 1, matrix_layout{1, 1}, T>();
    check_product<1, 64, matrix_layout{64, 1}, T>();
    check_product<12, 5, matrix_layout{5, 1}, T>();
    check_product<13, 5, matrix_layout{5, 1}, T>();
    check_product<22, 280, matrix_layout{280, 1}, T>();
    check_product<280, 22, matrix_layout{1, 280}, T>();
    check_product<25, 3, matrix_layout{1, 25}, T>();
}

namespace {

constexpr batch_convolution forward_of(shape in, std::size_t outputs, extent2d kernel = 3,
                                       extent2d stride = 1, padding around = padding::same) {
    return batch_convolution::forward(sliding_window::over(in, kernel, stride, around), outputs);
}
constexpr batch_convolution backward_of(shape in, std::size_t outputs, extent2d kernel = 3,
                                        extent2d stride = 1, padding around = padding::same) {
    return batch_convolution::backward(sliding_window::over(in, kernel, stride, around), outputs);
}

} // namespace

TEST_CASE("tile_grid: tiles cover the outputs, also where they reach beyond") {
    constexpr tile_grid tiles = tile_grid::of(forward_of({7, 13, 16}, 32), {4, 3});
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
    CHECK(winograd_possible(forward_of({7, 13, 16}, 32), 4));
    CHECK(winograd_possible(forward_of({7, 13, 16}, 32, 2), 5));
    CHECK_FALSE(winograd_possible(forward_of({7, 13, 16}, 32), 5)); // 7 numbers have no line
    CHECK_FALSE(winograd_possible(forward_of({7, 13, 16}, 32), {1, 4}));
    CHECK_FALSE(winograd_possible(forward_of({7, 13, 16}, 32, 5), 2));
    CHECK_FALSE(winograd_possible(forward_of({7, 13, 16}, 32, {2, 3}), 2));
    CHECK_FALSE(winograd_possible(forward_of({7, 13, 16}, 32, 3, 2), 2));
    CHECK_FALSE(winograd_possible(backward_of({7, 13, 16}, 32, 3, 2), 2)); // the same backwards: pixels apart
    CHECK(winograd_possible(forward_of({7, 13, 16}, 32, 3, 1, pad(2, 9, 2, 9)), 2));
    CHECK_FALSE(
        winograd_possible(forward_of({7, 13, 16}, 32, 3, 1, pad(3, 0, 0, 0)), 2)); // outputs of nothing
    CHECK_FALSE(winograd_possible(forward_of({7, 13, 16}, 32, 3, 1, pad(0, 0, 3, 0)), 2));
    CHECK(winograd_possible(backward_of({7, 13, 16}, 32, 3, 1, pad(2)), 2));
    CHECK_FALSE(winograd_possible(backward_of({7, 13, 16}, 32, 3, 1, pad(3)), 2)); // pixels that no tap reads
}

TEST_CASE("tile_grid: taps on padding are not counted") {
    const auto same_as_window = [](shape in, extent2d kernel, padding around) {
        const auto padded = sliding_window::over(in, kernel, 1, around);
        const std::size_t expected = 2 * padded.taps_on_pixels() * in.channels * 5;
        CHECK(direct_cost(batch_convolution::forward(padded, 5)) == expected);
        CHECK(direct_cost(batch_convolution::backward(padded, 5)) == expected);
    };
    same_as_window({7, 13, 16}, 3, padding::same);
    same_as_window({1, 2, 3}, 3, padding::same);
    same_as_window({4, 7, 2}, 2, padding::same);
    same_as_window({4, 7, 2}, 3, padding::valid);
    same_as_window({4, 7, 2}, 3, pad(2));
}

TEST_CASE("tile_grid: large tiles where they save products, none where transforms cost more") {
    CHECK(best_tile(forward_of({4, 7, 32}, 64)) == extent2d(4));
    CHECK(best_tile(backward_of({4, 7, 32}, 64)) == extent2d(4));
    CHECK(best_tile(forward_of({2, 4, 64}, 128)) == extent2d(2, 4));
    CHECK(best_tile(forward_of({1, 9, 64}, 128)) == extent2d(0)); // two of three rows of taps are on padding
    CHECK(best_tile(forward_of({28, 50, 1}, 8)) == extent2d(0));  // one channel
    CHECK(best_tile(forward_of({1, 1, 64}, 64)) == extent2d(0));  // one tap
    // The way does not depend on the instruction set nor on the precision.
    CHECK(winograd_lane_method<forward_of({4, 7, 32}, 64), float>::tile == extent2d(4));
    CHECK(winograd_lane_method<forward_of({4, 7, 32}, 64), double>::tile == extent2d(4));
}
