#include <tactnet/kernels/map/hartley.hpp>
#include <tactnet/kernels/map/symmetric_convolution.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <support/guarded_map.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

std::size_t bits_reversed(std::size_t index, std::size_t size) {
    std::size_t result = 0;
    for (std::size_t bit = 1; bit < size; bit *= 2, index /= 2)
        result = 2 * result + index % 2;
    return result;
}

/// The definition, in long double.
template <std::size_t Size>
void compare_hartley() {
    CAPTURE(Size);
    constexpr std::size_t width = lanes<double>;
    std::uint64_t state = Size;
    struct alignas(64) signals {
        double sample[Size * width];
    } given{}, transformed;
    for (double& each : given.sample)
        each = static_cast<double>(support::draw(state));
    transformed = given;
    const hartley<Size> transform;
    transform.to_reversed(transformed.sample);
    for (std::size_t lane = 0; lane < width; ++lane) {
        long double squares = 0;
        for (std::size_t n = 0; n < Size; ++n)
            squares += static_cast<long double>(given.sample[n * width + lane]) *
                       static_cast<long double>(given.sample[n * width + lane]);
        // A rounding or two in each of log₂ N steps, of numbers as large as √N times the root mean square.
        const long double bound = 2 * std::log2(static_cast<long double>(Size)) * std::sqrt(squares) *
                                  std::numeric_limits<double>::epsilon();
        for (std::size_t k = 0; k < Size; ++k) {
            long double sum = 0;
            for (std::size_t n = 0; n < Size; ++n) {
                const long double angle =
                    2 * std::numbers::pi_v<long double> * static_cast<long double>(n * k % Size) / Size;
                sum += static_cast<long double>(given.sample[n * width + lane]) *
                       (std::cos(angle) + std::sin(angle));
            }
            const long double found =
                static_cast<long double>(transformed.sample[bits_reversed(k, Size) * width + lane]);
            CHECK(std::abs(found - sum) <= bound);
        }
    }
    transform.from_reversed(transformed.sample);
    for (std::size_t i = 0; i < Size * width; ++i)
        CHECK(transformed.sample[i] / static_cast<double>(Size) ==
              doctest::Approx(given.sample[i]).epsilon(1e-14));
}

TEST_CASE("hartley: the fast transform is the sum that defines it, and its own inverse") {
    compare_hartley<4>();
    compare_hartley<8>();
    compare_hartley<16>();
    compare_hartley<128>();
    compare_hartley<512>();
}

/// Largest difference from the sum written out, in units of what rounding may do: the error of a fast
/// transform grows with the root mean square of its input and slowly with its length (Higham, Accuracy and
/// Stability of Numerical Algorithms, section 24.1).
template <shape Shape>
double error_in_roundings() {
    using convolution = symmetric_convolution<Shape>;
    std::uint64_t state = Shape.size();
    std::vector<double> kernel(Shape.size());
    for (double& each : kernel)
        each = static_cast<double>(support::draw(state));
    aligned_vector<double> from(convolution::size, 0.0), to(convolution::size, NAN);
    double squares = 0, influence = 0;
    for (std::size_t y = 0; y < Shape.rows; ++y)
        for (std::size_t x = 0; x < Shape.columns; ++x) {
            const double value = from[y * convolution::stride + x] =
                static_cast<double>(support::draw(state));
            squares += value * value;
            influence += 4 * std::abs(kernel[y * Shape.columns + x]);
        }
    convolution convolver;
    const auto spectrum =
        convolver.spectrum_of([&](std::size_t y, std::size_t x) { return kernel[y * Shape.columns + x]; });
    convolver.convolve(spectrum, from.data(), to.data());

    const auto apart = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
    double worst = 0;
    for (std::size_t row = 0; row < Shape.rows; ++row)
        for (std::size_t column = 0; column < Shape.columns; ++column) {
            double sum = 0;
            for (std::size_t y = 0; y < Shape.rows; ++y)
                for (std::size_t x = 0; x < Shape.columns; ++x)
                    sum += kernel[apart(row, y) * Shape.columns + apart(column, x)] *
                           from[y * convolution::stride + x];
            const double error = std::abs(to[row * convolution::stride + column] - sum);
            worst = error <= worst ? worst : error;
        }
    // Again, with the result in place of the input: the same bits.
    convolver.convolve(spectrum, from.data(), from.data());
    for (std::size_t row = 0; row < Shape.rows; ++row)
        for (std::size_t column = 0; column < Shape.columns; ++column)
            CHECK(from[row * convolution::stride + column] == to[row * convolution::stride + column]);
    return worst / (std::numeric_limits<double>::epsilon() * influence * std::sqrt(squares));
}

TEST_CASE("symmetric_convolution: the fast one is the sum written out") {
    CHECK(error_in_roundings<shape{28, 50}>() < 20);
    CHECK(error_in_roundings<shape{1, 1}>() < 20);
    CHECK(error_in_roundings<shape{1, 9}>() < 20);
    CHECK(error_in_roundings<shape{17, 1}>() < 20);
    CHECK(error_in_roundings<shape{16, 32}>() < 20);
    CHECK(error_in_roundings<shape{33, 65}>() < 20);
}

TEST_CASE("symmetric_convolution: nothing wraps around the edges") {
    constexpr shape size{5, 11};
    using convolution = symmetric_convolution<size>;
    convolution convolver;
    const auto spectrum =
        convolver.spectrum_of([](std::size_t y, std::size_t x) { return y == 4 || x == 10 ? 1.0 : 0.0; });
    aligned_vector<double> map(convolution::size, 0.0);
    map[0] = 1;
    convolver.convolve(spectrum, map.data(), map.data());
    for (std::size_t y = 0; y < size.rows; ++y)
        for (std::size_t x = 0; x < size.columns; ++x)
            CHECK(map[y * convolution::stride + x] ==
                  doctest::Approx(y == 4 || x == 10 ? 1 : 0).epsilon(1e-14));
}

std::size_t apart(std::size_t a, std::size_t b) {
    return a > b ? a - b : b - a;
}

/// Against the sum written out in double; half of the rows are empty.
template <shape Shape>
void compare_stencil(extent2d reach) {
    CAPTURE(Shape.columns);
    CAPTURE(reach.columns);
    std::uint64_t state = Shape.size();
    std::vector<float> weights(100 * 100);
    for (float& each : weights)
        each = std::abs(support::draw(state)); // none negative: sums of positives have no cancellation
    const auto weight = [&](std::size_t i, std::size_t j) { return weights[i * 100 + j]; };
    support::guarded_map map(Shape.size(), NAN, 0);
    for (std::size_t y = 0; y < Shape.rows; ++y)
        for (std::size_t x = 0; x < Shape.columns; ++x)
            map.data()[y * Shape.columns + x] = y % 4 < 2 ? std::abs(support::draw(state)) : 0;
    const std::vector<float> given(map.data(), map.data() + Shape.size());
    symmetric_stencil<Shape> stencil(reach, weight);
    stencil.apply(map.data());
    CHECK(map.untouched());
    for (std::size_t y = 0; y < Shape.rows; ++y)
        for (std::size_t x = 0; x < Shape.columns; ++x) {
            double sum = 0;
            for (std::size_t i = 0; i < Shape.rows; ++i)
                for (std::size_t j = 0; j < Shape.columns; ++j)
                    if (apart(y, i) <= reach.rows && apart(x, j) <= reach.columns)
                        sum += static_cast<double>(weight(apart(y, i), apart(x, j))) *
                               static_cast<double>(given[i * Shape.columns + j]);
            const double terms = static_cast<double>((2 * reach.rows + 1) * (2 * reach.columns + 1));
            CHECK(std::abs(static_cast<double>(map.data()[y * Shape.columns + x]) - sum) <=
                  terms * 0x1p-24 * sum);
        }
}

TEST_CASE("symmetric_stencil: it is the sum written out") {
    compare_stencil<shape{28, 50}>(3);
    compare_stencil<shape{28, 50}>({27, 49});
    compare_stencil<shape{28, 50}>(0);
    compare_stencil<shape{5, 3}>({7, 9});
    compare_stencil<shape{1, 1}>(4);
    compare_stencil<shape{3, 150}>({1, 20});
    compare_stencil<shape{9, 8}>({2, 7});
}

TEST_CASE("symmetric_stencil: NaN and negative pressures count as zero, too large ones as the maximum") {
    constexpr float most = std::numeric_limits<float>::max();
    constexpr shape size{4, 20};
    symmetric_stencil<size> stencil(1,
                                    [](std::size_t i, std::size_t j) { return i + j == 0 ? 0.5f : 0.0625f; });
    std::vector<float> map(size.size(), 0.0f);
    map[0] = NAN, map[1] = -5, map[3] = 16, map[30] = INFINITY;
    stencil.apply(map.data());
    CHECK(map[0] == 0);
    CHECK(map[1] == 0);
    CHECK(map[2] == 1);
    CHECK(map[3] == 8);
    CHECK(map[30] == most / 2);
    CHECK(map[31] == most / 16);
    CHECK(map[75] == 0);
}

TEST_CASE("symmetric_stencil: negative weights leave nothing below zero") {
    constexpr shape size{3, 9};
    symmetric_stencil<size> stencil({0, 1}, [](std::size_t, std::size_t j) { return j == 0 ? 2.0f : -0.5f; });
    std::vector<float> map(size.size(), 0.0f);
    map[13] = 8;
    stencil.apply(map.data());
    CHECK(map[13] == 16);
    CHECK(map[12] == 0);
    CHECK(map[14] == 0);
}

} // namespace
