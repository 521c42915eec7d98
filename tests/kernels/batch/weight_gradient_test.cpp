#include <tactnet/kernels/batch/weight_gradient.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <support/whole_numbers.hpp>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// [filter][channel][row][column], whichever way the sums were taken.
template <class T, sliding_window W, std::size_t Filters>
void compare() {
    using way = weight_gradient<W, Filters, T>;
    constexpr std::size_t width = lanes<T>, area = W.output_rows() * W.output_columns();
    const auto input = support::whole_numbers<T>(W.input.size() * width, 7919),
               gradient = support::whole_numbers<T>(Filters * area * width, 104729);
    aligned_vector<double> totals(way::totals);
    aligned_vector<T> scratch(way::scratch), found(Filters * W.input.channels * W.kernel.area());
    way::add(input.data(), gradient.data(), totals.data(), scratch.data(), 0, way::pieces);
    way::finish(totals.data(), found.data());
    std::size_t wrong = 0, w = 0;
    for (std::size_t f = 0; f < Filters; ++f)
        for (std::size_t c = 0; c < W.input.channels; ++c)
            for (std::size_t k = 0; k < W.kernel.area(); ++k, ++w) {
                double sum = 0, size = 0;
                for (std::size_t o = 0; o < area; ++o) {
                    const std::size_t y = o / W.output_columns() * W.stride.rows + k / W.kernel.columns -
                                          W.top,
                                      x = o % W.output_columns() * W.stride.columns + k % W.kernel.columns -
                                          W.left;
                    if (y < W.input.rows && x < W.input.columns)
                        for (std::size_t lane = 0; lane < width; ++lane) {
                            const auto product = static_cast<double>(
                                gradient[(f * area + o) * width + lane] *
                                input[((c * W.input.rows + y) * W.input.columns + x) * width + lane]);
                            sum += product, size += product < 0 ? -product : product;
                        }
                }
                // By tiles whole numbers are rounded, by less than one of these sums' terms.
                const double error = static_cast<double>(found[w]) - sum;
                wrong += !((error < 0 ? -error : error) <= (way::tiled ? 1e-4 * size : 0));
            }
    CHECK(wrong == 0);
}

} // namespace

TEST_CASE_TEMPLATE("weight_gradient: each weight in its place, by tiles, across channels, across samples", T,
                   float, double) {
    constexpr auto tiled = sliding_window::over({7, 13, 32}, 3, 1, same),
                   strided = sliding_window::over({7, 13, 2 * lanes<T>}, 3, 2, same),
                   odd = sliding_window::over({7, 13, 3}, 3, 1, same);
    CHECK(weight_gradient<tiled, 30, T>::tiled == (lanes < T >> 1));
    CHECK_FALSE(weight_gradient<strided, 30, T>::tiled);
    CHECK_FALSE(weight_gradient<odd, 30, T>::tiled);
    compare<T, tiled, 30>();
    compare<T, strided, 30>();
    compare<T, odd, 30>();
}
