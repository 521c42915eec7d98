#include <tactnet/kernels/map/symmetric_convolution.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <support/guarded_map.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

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

} // namespace
