#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/winograd/convolution.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <support/layers/tile_magnitudes.hpp>
#include <support/layers/window_of.hpp>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

// Against plain loops in double precision, each output within the bound of its error that
// support/layers/deployed_reference.hpp derives.

namespace {

/// What the plain loops need of a case. They are compiled once and not for each tile, which halves the
/// compile time of this file.
struct convolution_case {
    support::reference_window window;
    std::size_t filters, width;
    support::tile_size tile;
    double share; ///< the bound of an error relative to the sum of magnitudes
    std::vector<double> weights, biases;
};

void check_convolution(const convolution_case& c, const std::vector<double>& in,
                       const std::vector<double>& found) {
    const std::size_t channels = c.window.input.channels, pixels = c.window.input.area(),
                      taps = c.window.kernel_rows * c.window.kernel_columns,
                      outputs = c.window.output_rows() * c.window.output_columns();
    std::size_t wrong = 0;
    double worst = 0, largest = 0;
    for (std::size_t lane = 0; lane < c.width; ++lane) {
        std::vector<double> sample(in.size() / c.width), magnitudes(sample.size()),
            expected(found.size() / c.width);
        for (std::size_t i = 0; i < sample.size(); ++i) {
            sample[i] = in[i * c.width + lane];
            magnitudes[i] = std::abs(sample[i]);
        }
        for (std::size_t k = 0; k < c.filters * channels; ++k)
            c.window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                expected[k / channels * outputs + to] +=
                    c.weights[k * taps + tap] * sample[k % channels * pixels + from];
            });
        const std::vector<double> sizes =
            support::tile_magnitudes(c.window, c.filters, c.weights, magnitudes, c.tile).sizes;
        for (std::size_t o = 0; o < expected.size(); ++o) {
            const double added = c.biases[o / outputs],
                         error = std::abs(found[o * c.width + lane] - expected[o] - added),
                         bound = c.share * (sizes[o] + std::abs(added));
            wrong += !(error <= bound);
            worst = std::max(worst, error / bound);
            largest = std::max(largest, std::abs(expected[o]));
        }
    }
    CAPTURE(worst);
    CHECK(wrong == 0);
    CHECK(largest > 0); // or nothing was compared
}

template <class T, sliding_window W, std::size_t Filters, extent2d Outputs>
void compare(bool biased = true) {
    constexpr batch_convolution c = batch_convolution::forward(W, Filters);
    using method = winograd_lane_method<c, T, Outputs>;
    constexpr std::size_t width = lanes<T>, channels = W.input.channels, taps = W.kernel.area();
    support::guarded_numbers<T> in(W.input.size() * width), weights(Filters * channels * taps), bias(Filters),
        packed(method::packed_elements), workspace(method::workspace_elements), out(c.output.size() * width);
    const std::vector<double> image = support::draw_into(in, 7), filters = support::draw_into(weights, 8);
    std::vector<double> added = support::draw_into(bias, 9);
    if (!biased)
        added.assign(Filters, 0);
    method::pack(
        [&](auto f, auto channel, auto row, auto column) {
            return weights
                .data()[((f * channels + channel) * W.kernel.rows + row) * W.kernel.columns + column];
        },
        packed.data());
    method::run(packed.data(), biased ? bias.data() : nullptr, in.data(), out.data(), workspace.data());
    CHECK((packed.untouched() && workspace.untouched() && out.untouched()));
    // G g Gᵀ is taken in double: a rounding of a single number, or up to six in each direction. The sums by
    // taps that these are held to round too.
    const double roundings = static_cast<double>(channels) + (sizeof(T) > 4 ? 34 : 23),
                 share = support::accumulated(support::unit_roundoff<T>, roundings) +
                         support::accumulated(support::unit_roundoff<double>,
                                              static_cast<double>(channels * taps + 1));
    check_convolution(
        {support::window_of(W), Filters, width, {Outputs.rows, Outputs.columns}, share, filters, added},
        image, {out.begin(), out.end()});
}

// 9 filters are one more than a register block, 7 × 11 is no multiple of any tile but one.
template <class T, std::size_t Kernel>
void every_tile() {
    unroll<(6 - Kernel) * (6 - Kernel)>([](auto i) {
        compare<T, sliding_window::over({7, 11, 5}, Kernel, 1, padding::same), 9,
                extent2d(i / (6 - Kernel) + 2, i % (6 - Kernel) + 2)>(i % 2 == 0);
    });
}

} // namespace

TEST_CASE_TEMPLATE("winograd_lane_method: every tile of a 3 × 3 kernel", T, float, double) {
    every_tile<T, 3>();
}
TEST_CASE_TEMPLATE("winograd_lane_method: every tile of a 2 × 2 kernel", T, float, double) {
    every_tile<T, 2>();
}
TEST_CASE_TEMPLATE(
    "winograd_lane_method: maps smaller than a tile, without padding, with more than the kernel's", T, float,
    double) {
    compare<T, sliding_window::over({1, 1, 3}, 3, 1, padding::same), 4, extent2d(4)>();
    compare<T, sliding_window::over({2, 3, 16}, 3, 1, padding::same), 24, extent2d(2, 4)>();
    compare<T, sliding_window::over({9, 6, 2}, 3, 1, padding::valid), 8, extent2d(3, 4)>();
    compare<T, sliding_window::over({4, 5, 2}, 3, 1, pad(2, 0, 1, 3)), 3, extent2d(2)>();
}
TEST_CASE("winograd_lane_method: maps in several bands") {
    constexpr auto window = sliding_window::over({30, 30, 32}, 3, 1, padding::same);
    using method = winograd_lane_method<batch_convolution::forward(window, 8), float, extent2d(4)>;
    if constexpr (lanes<float> >= 8) // else all that is transformed stays near
        static_assert(method::band < method::tiles.count() && method::tiles.count() % method::band != 0);
    compare<float, window, 8, extent2d(4)>();
}
