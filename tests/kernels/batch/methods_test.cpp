#include <tactnet/kernels/batch/channel_gradient.hpp>
#include <tactnet/kernels/batch/methods.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <support/guarded_map.hpp>
#include <support/layers/tile_magnitudes.hpp>
#include <support/layers/window_of.hpp>
#include <support/tolerance.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// The exact gradient of a weight, by plain loops over whole numbers.
template <class T, sliding_window W>
double gradient_of(const aligned_vector<T>& input, const aligned_vector<T>& gradient, std::size_t filter,
                   std::size_t channel, std::size_t tap) {
    constexpr std::size_t width = lanes<T>, plane = W.output_rows() * W.output_columns();
    double sum = 0;
    for (std::size_t o = 0; o < plane; ++o) {
        const std::size_t y = o / W.output_columns() * W.stride.rows + tap / W.kernel.columns - W.top,
                          x = o % W.output_columns() * W.stride.columns + tap % W.kernel.columns - W.left;
        if (y < W.input.rows && x < W.input.columns)
            for (std::size_t lane = 0; lane < width; ++lane)
                sum += static_cast<double>(
                    gradient[(filter * plane + o) * width + lane] *
                    input[((channel * W.input.rows + y) * W.input.columns + x) * width + lane]);
    }
    return sum;
}

/// Where the sum of a weight must be: filter by filter, tap by tap, channels side by side.
template <sliding_window W>
std::size_t weight(std::size_t filter, std::size_t channel, std::size_t tap) {
    return (filter * W.kernel.area() + tap) * W.input.channels + channel;
}

/// Against plain loops, all pieces and then one after the other.
template <class T, sliding_window W, std::size_t Filters>
void compare_channels() {
    using method = channel_gradient<batch_convolution::forward(W, Filters), T>;
    if constexpr (method::applicable) {
        constexpr std::size_t width = lanes<T>, plane = W.output_rows() * W.output_columns();
        const auto input = support::whole_numbers<T>(W.input.size() * width, 7919),
                   gradient = support::whole_numbers<T>(Filters * plane * width, 104729);
        aligned_vector<double> expected(Filters * W.input.channels * W.kernel.area(), 1), found(expected),
            by_pieces(expected);
        for (std::size_t f = 0; f < Filters; ++f)
            for (std::size_t c = 0; c < W.input.channels; ++c)
                for (std::size_t k = 0; k < W.kernel.area(); ++k)
                    expected[weight<W>(f, c, k)] += gradient_of<T, W>(input, gradient, f, c, k);
        aligned_vector<T> workspace(method::workspace_elements);
        method::add(input.data(), gradient.data(), found.data(), workspace.data(), 0, method::pieces);
        CHECK(found == expected);
        for (std::size_t piece = 0; piece < method::pieces; ++piece)
            method::add(input.data(), gradient.data(), by_pieces.data(), workspace.data(), piece, piece + 1);
        CHECK(by_pieces == expected);
    }
}

} // namespace

TEST_CASE_TEMPLATE("channel_gradient: against plain loops, piece by piece too", T, float, double) {
    compare_channels<T, sliding_window::over({3, 4, 16}, 3, 1, padding::same), 30>();
    compare_channels<T, sliding_window::over({5, 3, 32}, extent2d{2, 3}, 2, padding::same), 13>();
    compare_channels<T, sliding_window::over({4, 20, 48}, 3, 1, padding::valid), 2>();
    compare_channels<T, sliding_window::over({1, 1, 64}, 3, 1, padding::same), 1>();
}

TEST_CASE("channel_gradient: every weight has a place of its own") {
    constexpr std::size_t filters = 5;
    constexpr auto window = sliding_window::over({5, 3, 64}, extent2d{2, 3}, 2, padding::same);
    using method = channel_gradient<batch_convolution::forward(window, filters), float>;
    std::vector<int> used(filters * window.input.channels * window.kernel.area());
    for (std::size_t f = 0; f < filters; ++f)
        for (std::size_t c = 0; c < window.input.channels; ++c)
            for (std::size_t k = 0; k < window.kernel.area(); ++k) {
                const std::size_t place =
                    method::place(f, c, k / window.kernel.columns, k % window.kernel.columns);
                CHECK(place == weight<window>(f, c, k));
                ++used.at(place);
            }
    CHECK(used == std::vector<int>(used.size(), 1));
}

TEST_CASE("channel_gradient: many threads have work, and wide maps are left to the other way") {
    if constexpr (lanes < float >> 1) {
        CHECK(channel_gradient<batch_convolution::forward(
                                   sliding_window::over({2, 4, 64}, 3, 1, padding::same), 128),
                               float>::pieces >= 8);
        CHECK_FALSE(channel_gradient<batch_convolution::forward(
                                         sliding_window::over({28, 5000, 64}, 3, 1, padding::same), 8),
                                     float>::applicable);
    }
    CHECK_FALSE(
        channel_gradient<batch_convolution::forward(sliding_window::over({4, 4, 1}, 3, 1, padding::same), 8),
                         double>::applicable);
}

namespace {

template <batch_convolution C, class T>
inline constexpr bool by_tiles = std::is_same_v<weight_gradient<C, T>, winograd_gradient<C, T>>;

/// [filter][channel][row][column], whichever method is chosen.
template <class T, sliding_window W, std::size_t Filters>
void compare() {
    constexpr auto description = batch_convolution::forward(W, Filters);
    using method = weight_gradient<description, T>;
    constexpr std::size_t width = lanes<T>, area = W.output_rows() * W.output_columns();
    const auto input = support::whole_numbers<T>(W.input.size() * width, 7919),
               gradient = support::whole_numbers<T>(Filters * area * width, 104729);
    aligned_vector<double> totals(method::totals);
    aligned_vector<T> workspace(method::workspace_elements),
        found(Filters * W.input.channels * W.kernel.area());
    method::add(input.data(), gradient.data(), totals.data(), workspace.data(), 0, method::pieces);
    method::finish(totals.data(), found.data());
    // By taps whole numbers are not rounded. By tiles they are, as winograd/gradient_test.cpp counts.
    std::vector<double> errors(found.size());
    if constexpr (by_tiles<description, T>) {
        for (std::size_t lane = 0; lane < width; ++lane) {
            std::vector<double> x(W.input.size()), dy(Filters * area);
            for (std::size_t i = 0; i < x.size(); ++i)
                x[i] = std::abs(static_cast<double>(input[i * width + lane]));
            for (std::size_t i = 0; i < dy.size(); ++i)
                dy[i] = std::abs(static_cast<double>(gradient[i * width + lane]));
            support::add_gradient_magnitudes(support::window_of(W), Filters, x, dy,
                                             {method::tile.rows, method::tile.columns},
                                             std::span<double>(errors));
        }
        for (double& e : errors)
            e *= support::accumulated(support::unit_roundoff<T>, static_cast<double>(area * width) + 34);
    }
    std::size_t wrong = 0, w = 0;
    for (std::size_t f = 0; f < Filters; ++f)
        for (std::size_t c = 0; c < W.input.channels; ++c)
            for (std::size_t k = 0; k < W.kernel.area(); ++k, ++w) {
                const double sum = gradient_of<T, W>(input, gradient, f, c, k);
                wrong += !(std::abs(static_cast<double>(found[w]) - sum) <= errors[w]);
            }
    CHECK(wrong == 0);
}

} // namespace

TEST_CASE_TEMPLATE("weight_gradient: each weight in its place, by tiles, across channels, across samples", T,
                   float, double) {
    constexpr auto tiled = sliding_window::over({7, 13, 32}, 3, 1, padding::same),
                   strided = sliding_window::over({7, 13, 2 * lanes<T>}, 3, 2, padding::same),
                   odd = sliding_window::over({7, 13, 3}, 3, 1, padding::same);
    if (lanes<T> >= 4) // else each number is transformed again for few sums
        CHECK(by_tiles<batch_convolution::forward(tiled, 30), T>);
    CHECK_FALSE(by_tiles<batch_convolution::forward(strided, 30), T>);
    CHECK_FALSE(by_tiles<batch_convolution::forward(odd, 30), T>);
    compare<T, tiled, 30>();
    compare<T, strided, 30>();
    compare<T, odd, 30>();
}
