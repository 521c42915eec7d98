#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <support/whole_numbers.hpp>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

constexpr sliding_window window = sliding_window::over({4, 6, 1}, 2, 2, padding::same);
constexpr std::size_t pixels = 24, windows = 6;

} // namespace

TEST_CASE_TEMPLATE(
    "normalised_pool_forward: the largest of the normalised, a falling rule takes the smallest", T, float,
    double) {
    constexpr std::size_t width = lanes<T>;
    const auto input = support::whole_numbers<T>(pixels * width, 7919);
    aligned_vector<T> output(windows * width), chosen(windows * width), behind_chosen(windows * width);
    for (const T scale : {T{2}, T{-2}, T{0}}) {
        const normalising<T> rule{1, scale, 3};
        normalised_pool_forward<window>(rule, input.data(), output.data());
        choose_for_pool<window>(static_cast<T>((scale > 0) - (scale < 0)), input.data(), chosen.data());
        normalise_and_rectify(rule, chosen.data(), behind_chosen.data(), windows * width);
        for (std::size_t o = 0; o < windows; ++o)
            for (std::size_t lane = 0; lane < width; ++lane) {
                T best = -1000, behind = 0;
                for (std::size_t k = 0; k < 4; ++k) {
                    const T x = input[((o / 3 * 2 + k / 2) * 6 + o % 3 * 2 + k % 2) * width + lane];
                    if ((x - 1) * scale + 3 > best)
                        best = (x - 1) * scale + 3, behind = x;
                }
                CHECK(output[o * width + lane] == (best > 0 ? best : 0));
                CHECK(chosen[o * width + lane] == behind);
                CHECK(behind_chosen[o * width + lane] == output[o * width + lane]);
            }
    }
}
TEST_CASE_TEMPLATE("normalised_pool_forward: a NaN is kept, whatever comes before and after it", T, float,
                   double) {
    constexpr std::size_t width = lanes<T>;
    for (const std::size_t at : {0u, 1u, 6u, 7u}) {
        aligned_vector<T> input(pixels * width, T{5}), output(windows * width);
        input[at * width] = static_cast<T>(std::nan(""));
        normalised_pool_forward<window>(normalising<T>{0, 1, 0}, input.data(), output.data());
        const auto broken_alone = [&] {
            CHECK(std::isnan(output[0]));
            for (std::size_t i = 1; i < output.size(); ++i)
                CHECK(output[i] == 5);
        };
        broken_alone();
        for (const T sign : {T{1}, T{-1}, T{0}}) {
            choose_for_pool<window>(sign, input.data(), output.data());
            broken_alone();
            normalise_and_rectify(normalising<T>{0, 1, 0}, output.data(), output.data(), output.size());
            broken_alone();
        }
    }
}
TEST_CASE_TEMPLATE("normalised_pool_backward: the first of equal elements, none where ReLU is zero", T, float,
                   double) {
    constexpr std::size_t width = lanes<T>;
    const aligned_vector<T> input(pixels * width, T{5}), chosen(windows * width, T{5}),
        output_gradient(windows * width, T{7});
    aligned_vector<T> output(windows * width, T{5}), input_gradient(pixels * width, T{99});
    for (std::size_t lane = 0; lane < width; ++lane)
        output[lane] = 0; // the first window
    const normalising_gradient<T> rule{0, 0, 0, 2};
    normalised_pool_backward<window>(rule, lanes_in_use<T>(width), input.data(), output.data(), chosen.data(),
                                     output_gradient.data(), input_gradient.data());
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        const bool first = pixel / 6 % 2 == 0 && pixel % 2 == 0;
        CHECK(input_gradient[pixel * width] == (first && pixel != 0 ? 14 : 0));
    }
}
