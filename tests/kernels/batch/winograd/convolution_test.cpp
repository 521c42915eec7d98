#include <tactnet/kernels/batch/winograd/convolution.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
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

template <class T, sliding_window W, std::size_t Filters, extent2d Outputs>
void compare(bool biased = true) {
    constexpr batch_convolution c = batch_convolution::forward(W, Filters);
    using method = winograd_lane_method<c, T, Outputs>;
    constexpr std::size_t width = lanes<T>, channels = W.input.channels, taps = W.kernel.area(),
                          pixels = W.input.area(), outputs = c.output.area();
    std::uint64_t state = 7;
    support::guarded_numbers<T> in(W.input.size() * width), packed(method::packed_elements),
        workspace(method::workspace_elements), out(c.output.size() * width);
    std::vector<double> weights(Filters * channels * taps);
    for (double& w : weights)
        w = static_cast<double>(support::draw(state));
    for (T& x : in)
        x = static_cast<T>(support::draw(state));
    std::vector<T> bias(Filters);
    for (T& b : bias)
        b = static_cast<T>(support::draw(state));
    method::pack(
        [&](auto f, auto channel, auto row, auto column) {
            return static_cast<T>(
                weights[((f * channels + channel) * W.kernel.rows + row) * W.kernel.columns + column]);
        },
        packed.data());
    method::run(packed.data(), biased ? bias.data() : nullptr, in.data(), out.data(), workspace.data());
    CHECK(packed.untouched());
    CHECK(workspace.untouched());
    CHECK(out.untouched());

    std::size_t wrong = 0;
    double worst = 0, largest = 0;
    for (std::size_t lane = 0; lane < width; ++lane) {
        std::vector<double> sample(W.input.size()), magnitudes(W.input.size()), expected(c.output.size());
        for (std::size_t i = 0; i < sample.size(); ++i) {
            sample[i] = static_cast<double>(in.data()[i * width + lane]);
            magnitudes[i] = std::abs(sample[i]);
        }
        const support::reference_window window = support::window_of(W);
        for (std::size_t f = 0; f < Filters; ++f)
            for (std::size_t channel = 0; channel < channels; ++channel)
                window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t tap) {
                    expected[f * outputs + to] +=
                        weights[(f * channels + channel) * taps + tap] * sample[channel * pixels + from];
                });
        const std::vector<double> sizes =
            support::tile_magnitudes(window, Filters, weights, magnitudes, {Outputs.rows, Outputs.columns})
                .sizes;
        // G g Gᵀ is taken in double: a rounding of a single number, or up to six in each direction. The sums
        // by taps that these are held to round too.
        const double roundings = static_cast<double>(channels) + (sizeof(T) > 4 ? 34 : 23),
                     share = support::accumulated(support::unit_roundoff<T>, roundings) +
                             support::accumulated(support::unit_roundoff<double>,
                                                  static_cast<double>(channels * taps + 1));
        for (std::size_t o = 0; o < expected.size(); ++o) {
            const double added = biased ? static_cast<double>(bias[o / outputs]) : 0,
                         error = std::abs(static_cast<double>(out.data()[o * width + lane]) - expected[o] -
                                          added),
                         bound = share * (sizes[o] + std::abs(added));
            wrong += !(error <= bound);
            worst = std::max(worst, error / bound);
            largest = std::max(largest, std::abs(expected[o]));
        }
    }
    CAPTURE(worst);
    CHECK(wrong == 0);
    CHECK(largest > 0); // or nothing was compared
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
