#include <tactnet/kernels/batch/winograd/gradient.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <support/guarded_map.hpp>
#include <support/layers/tile_magnitudes.hpp>
#include <support/layers/window_of.hpp>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

// Against plain loops in double precision, each weight within the bound of its error.

namespace {

/// Two lane blocks one after the other, all pieces and then one by one.
template <class T, sliding_window W, std::size_t Filters, extent2d Outputs>
void compare() {
    if constexpr (winograd_gradient_possible<T>(batch_convolution::forward(W, Filters), Outputs)) {
        using method = winograd_gradient<batch_convolution::forward(W, Filters), T, Outputs>;
        constexpr std::size_t width = lanes<T>, channels = W.input.channels, taps = W.kernel.area(),
                              pixels = W.input.area(), outputs = W.output_rows() * W.output_columns(),
                              blocks = 2;
        std::uint64_t state = 11;
        support::guarded_numbers<T> in(blocks * W.input.size() * width),
            gradient(blocks * Filters * outputs * width), workspace(method::workspace_elements),
            found(Filters * channels * taps);
        support::guarded_numbers<double> totals(method::totals), by_pieces(method::totals);
        for (T& x : in)
            x = static_cast<T>(support::draw(state));
        for (T& x : gradient)
            x = static_cast<T>(support::draw(state));
        std::fill(totals.begin(), totals.end(), 0.0);
        std::fill(by_pieces.begin(), by_pieces.end(), 0.0);
        for (std::size_t g = 0; g < blocks; ++g) {
            const T *const x = in.data() + g * W.input.size() * width, *const dy =
                                                                           gradient.data() +
                                                                           g * Filters * outputs * width;
            method::add(x, dy, totals.data(), workspace.data(), 0, method::pieces);
            for (std::size_t piece = method::pieces; piece-- > 0;)
                method::add(x, dy, by_pieces.data(), workspace.data(), piece, piece + 1);
        }
        method::finish(totals.data(), found.data());
        CHECK(std::equal(totals.begin(), totals.end(), by_pieces.begin()));
        CHECK(totals.untouched());
        CHECK(workspace.untouched());
        CHECK(found.untouched());

        const support::reference_window window = support::window_of(W);
        std::vector<double> expected(Filters * channels * taps), sizes(expected.size());
        for (std::size_t s = 0; s < blocks * width; ++s) {
            const auto sample = [&](support::guarded_numbers<T>& from, std::size_t size) {
                std::vector<double> result(size);
                for (std::size_t i = 0; i < size; ++i)
                    result[i] = static_cast<double>(from.data()[(s / width * size + i) * width + s % width]);
                return result;
            };
            std::vector<double> x = sample(in, W.input.size()), dy = sample(gradient, Filters * outputs);
            for (std::size_t k = 0; k < Filters * channels; ++k)
                window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                    expected[k * taps + tap] +=
                        x[k % channels * pixels + from] * dy[k / channels * outputs + to];
                });
            for (double& each : x)
                each = std::abs(each);
            for (double& each : dy)
                each = std::abs(each);
            support::add_gradient_magnitudes(window, Filters, x, dy, {Outputs.rows, Outputs.columns},
                                             std::span<double>(sizes));
        }
        // Roundings of both transforms, a product, the sum of one band and the result; in double those of the
        // totals, of Gᵀ t G, and of the sums that these are held to.
        const double share =
            support::accumulated(support::unit_roundoff<T>,
                                 static_cast<double>(method::band_tiles * width) + 18) +
            support::accumulated(support::unit_roundoff<double>,
                                 static_cast<double>(blocks * (method::tiles.rows + width * outputs) + 16));
        std::size_t wrong = 0;
        double worst = 0, largest = 0;
        for (std::size_t w = 0; w < expected.size(); ++w) {
            const double error = std::abs(static_cast<double>(found.data()[w]) - expected[w]);
            wrong += !(error <= share * sizes[w]);
            worst = std::max(worst, error / (share * sizes[w]));
            largest = std::max(largest, std::abs(expected[w]));
        }
        CAPTURE(worst);
        CHECK(wrong == 0);
        CHECK(largest > 0); // or nothing was compared
    }
}

template <class T, std::size_t Kernel>
void every_tile() {
    unroll<(6 - Kernel) * (6 - Kernel)>([](auto i) {
        compare<T, sliding_window::over({5, 7, lanes<T>}, Kernel, 1, padding::same), 3,
                extent2d(i / (6 - Kernel) + 2, i % (6 - Kernel) + 2)>();
    });
}

} // namespace

TEST_CASE_TEMPLATE("winograd_gradient: every tile of a 3 × 3 kernel", T, float, double) {
    every_tile<T, 3>();
}
TEST_CASE_TEMPLATE("winograd_gradient: every tile of a 2 × 2 kernel", T, float, double) {
    every_tile<T, 2>();
}
TEST_CASE_TEMPLATE("winograd_gradient: blocks of channels and of filters that are not full, maps in bands", T,
                   float, double) {
    constexpr std::size_t three = 3 * lanes<T>; // vectors: a block of two and one of one
    compare<T, sliding_window::over({4, 3, three}, 3, 1, padding::same), max_block_sums / 2 + 1,
            extent2d(2)>();
    compare<T, sliding_window::over({1, 1, three}, 3, 1, padding::same), 2, extent2d(4)>();
    compare<T, sliding_window::over({4, 5, lanes<T>}, 3, 1, pad(2, 0, 1, 2)), 1, extent2d(2)>();
    // Filters in lanes.
    compare<T, sliding_window::over({4, 5, 3}, 3, 1, pad(2, 0, 1, 2)), three, extent2d(2, 4)>();
    compare<T, sliding_window::over({7, 3, max_block_sums / 2 + 1}, 2, 1, padding::same), three,
            extent2d(3)>();
    compare<T, sliding_window::over({11, 40, 12}, 3, 1, padding::valid), 2 * lanes<T>, extent2d(2)>();
    constexpr auto wide = sliding_window::over({11, 40, 2 * lanes<T>}, 3, 1, padding::valid);
    if constexpr (lanes < T >> 4) {
        using method = winograd_gradient<batch_convolution::forward(wide, 12), T, extent2d(2)>;
        static_assert(method::band_rows < method::tiles.rows);
    }
    compare<T, wide, 12, extent2d(2)>();
}

TEST_CASE("winograd_gradient: channels that fill no vector, and maps that no near cache holds, have none") {
    if constexpr (lanes < float >> 1)
        CHECK_FALSE(winograd_gradient_possible<float>(
            batch_convolution::forward(sliding_window::over({4, 4, lanes<float> + 1}, 3, 1, padding::same),
                                       2 * lanes<float> - 1),
            2));
    CHECK_FALSE(winograd_gradient_possible<float>(
        batch_convolution::forward(sliding_window::over({4, 40000, 64}, 3, 1, padding::same), 8), 2));
}
