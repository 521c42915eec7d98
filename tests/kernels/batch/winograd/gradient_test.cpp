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

/// What the plain loops need of a case. They are compiled once and not for each tile, which halves the
/// compile time of this file.
struct gradient_case {
    support::reference_window window;
    std::size_t filters, samples, width;
    support::tile_size tile;
    double share; ///< the bound of an error relative to the sum of magnitudes
};

/// Elements of sample `s` of maps in lane blocks.
std::vector<double> sample_of(const gradient_case& c, const std::vector<double>& maps, std::size_t s) {
    std::vector<double> result(maps.size() / c.samples);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = maps[(s / c.width * result.size() + i) * c.width + s % c.width];
    return result;
}

// Without vectors no gradient is computed in tiles.
[[maybe_unused]] void check_gradient(const gradient_case& c, const std::vector<double>& in,
                                     const std::vector<double>& gradient, const std::vector<double>& found) {
    const std::size_t taps = c.window.kernel_rows * c.window.kernel_columns,
                      channels = c.window.input.channels, pixels = c.window.input.area(),
                      outputs = c.window.output_rows() * c.window.output_columns();
    std::vector<double> expected(c.filters * channels * taps), sizes(expected.size());
    for (std::size_t s = 0; s < c.samples; ++s) {
        std::vector<double> x = sample_of(c, in, s), dy = sample_of(c, gradient, s);
        for (std::size_t k = 0; k < c.filters * channels; ++k)
            c.window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                expected[k * taps + tap] += x[k % channels * pixels + from] * dy[k / channels * outputs + to];
            });
        for (double& each : x)
            each = std::abs(each);
        for (double& each : dy)
            each = std::abs(each);
        support::add_gradient_magnitudes(c.window, c.filters, x, dy, c.tile, std::span<double>(sizes));
    }
    std::size_t wrong = 0;
    double worst = 0, largest = 0;
    for (std::size_t w = 0; w < expected.size(); ++w) {
        const double error = std::abs(found[w] - expected[w]), bound = c.share * sizes[w];
        wrong += !(error <= bound);
        worst = std::max(worst, error / bound);
        largest = std::max(largest, std::abs(expected[w]));
    }
    CAPTURE(worst);
    CHECK(wrong == 0);
    CHECK(largest > 0); // or nothing was compared
}

/// Two lane blocks one after the other, all pieces and then one by one.
template <class T, sliding_window W, std::size_t Filters, extent2d Outputs>
void compare() {
    if constexpr (winograd_gradient_possible<T>(batch_convolution::forward(W, Filters), Outputs)) {
        using method = winograd_gradient<batch_convolution::forward(W, Filters), T, Outputs>;
        constexpr std::size_t width = lanes<T>, outputs = W.output_rows() * W.output_columns(), blocks = 2;
        support::guarded_numbers<T> in(blocks * W.input.size() * width),
            gradient(blocks * Filters * outputs * width), workspace(method::workspace_elements),
            found(Filters * W.input.channels * W.kernel.area());
        support::guarded_numbers<double> totals(method::totals), by_pieces(method::totals);
        const std::vector<double> images = support::draw_into(in, 11),
                                  gradients = support::draw_into(gradient, 12);
        std::fill(totals.begin(), totals.end(), 0.0);
        std::fill(by_pieces.begin(), by_pieces.end(), 0.0);
        for (std::size_t g = 0; g < blocks; ++g) {
            const T* const x = in.data() + g * W.input.size() * width;
            const T* const dy = gradient.data() + g * Filters * outputs * width;
            method::add(x, dy, totals.data(), workspace.data(), 0, method::pieces);
            for (std::size_t piece = method::pieces; piece-- > 0;)
                method::add(x, dy, by_pieces.data(), workspace.data(), piece, piece + 1);
        }
        method::finish(totals.data(), found.data());
        CHECK(std::equal(totals.begin(), totals.end(), by_pieces.begin()));
        CHECK((totals.untouched() && workspace.untouched() && found.untouched()));
        // Roundings of both transforms, a product, the sum of one band and the result; in double those of the
        // totals, of Gᵀ t G, and of the sums that these are held to.
        const double share =
            support::accumulated(support::unit_roundoff<T>,
                                 static_cast<double>(method::band_tiles * width) + 18) +
            support::accumulated(support::unit_roundoff<double>,
                                 static_cast<double>(blocks * (method::tiles.rows + width * outputs) + 16));
        check_gradient(
            {support::window_of(W), Filters, blocks * width, width, {Outputs.rows, Outputs.columns}, share},
            images, gradients, {found.begin(), found.end()});
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
