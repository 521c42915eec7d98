#include <tactnet/kernels/batch/methods.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <support/layers/tile_magnitudes.hpp>
#include <support/layers/window_of.hpp>
#include <support/tolerance.hpp>
#include <support/whole_numbers.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

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
                double sum = 0;
                for (std::size_t o = 0; o < area; ++o) {
                    const std::size_t y = o / W.output_columns() * W.stride.rows + k / W.kernel.columns -
                                          W.top,
                                      x = o % W.output_columns() * W.stride.columns + k % W.kernel.columns -
                                          W.left;
                    if (y < W.input.rows && x < W.input.columns)
                        for (std::size_t lane = 0; lane < width; ++lane)
                            sum += static_cast<double>(
                                gradient[(f * area + o) * width + lane] *
                                input[((c * W.input.rows + y) * W.input.columns + x) * width + lane]);
                }
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
