#include <tactnet/kernels/batch/channel_gradient.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <support/whole_numbers.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// Where the sum of a weight must be: filter by filter, tap by tap, channels side by side.
template <sliding_window W>
std::size_t weight(std::size_t filter, std::size_t channel, std::size_t tap) {
    return (filter * W.kernel.area() + tap) * W.input.channels + channel;
}

/// Against plain loops, all pieces and then one after the other.
template <class T, sliding_window W, std::size_t Filters>
void compare() {
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
                    for (std::size_t o = 0; o < plane; ++o) {
                        const std::size_t row = k / W.kernel.columns, column = k % W.kernel.columns;
                        const std::size_t y = o / W.output_columns() * W.stride.rows + row - W.top,
                                          x = o % W.output_columns() * W.stride.columns + column - W.left;
                        if (y < W.input.rows && x < W.input.columns)
                            for (std::size_t lane = 0; lane < width; ++lane)
                                expected[weight<W>(f, c, k)] += static_cast<double>(
                                    gradient[(f * plane + o) * width + lane] *
                                    input[((c * W.input.rows + y) * W.input.columns + x) * width + lane]);
                    }
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
    compare<T, sliding_window::over({3, 4, 16}, 3, 1, padding::same), 30>();
    compare<T, sliding_window::over({5, 3, 32}, extent2d{2, 3}, 2, padding::same), 13>();
    compare<T, sliding_window::over({4, 20, 48}, 3, 1, padding::valid), 2>();
    compare<T, sliding_window::over({1, 1, 64}, 3, 1, padding::same), 1>();
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
