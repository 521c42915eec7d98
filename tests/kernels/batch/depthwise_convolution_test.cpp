#include <tactnet/kernels/batch/methods.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <support/guarded_map.hpp>
#include <type_traits>

using namespace tactnet;
using namespace tactnet::kernels;

// Against the methods that compute one group after the other: the same bits.

namespace {

template <batch_convolution C, class T>
void compare_convolution() {
    using method = depthwise_lane_method<C, T>;
    using one = direct_lane_method<C.one_group(), T>;
    static_assert(std::is_same_v<lane_convolution<C, T>, method>);
    constexpr std::size_t width = lanes<T>, taps = C.kernel.area();
    const auto input = support::whole_numbers<T>(C.input.size() * width, 7919),
               weights = support::whole_numbers<T>(C.weights(), 104729),
               bias = support::whole_numbers<T>(C.output.channels, 31);
    const auto scaled = [](const T& value) { return value / T{7}; }; // so that sums are rounded
    aligned_vector<T> packed(method::packed_elements), one_packed(one::packed_elements),
        found(C.output.size() * width, T{99}), expected(C.output.size() * width, T{98});
    for (const bool biased : {false, true}) {
        method::pack(
            [&](std::size_t output, std::size_t, std::size_t row, std::size_t column) {
                return scaled(weights[output * taps + row * C.kernel.columns + column]);
            },
            packed.data());
        method::run(packed.data(), biased ? bias.data() : nullptr, input.data(), found.data(), nullptr);
        for (std::size_t channel = 0; channel < C.input.channels; ++channel) {
            one::pack(
                [&](std::size_t, std::size_t, std::size_t row, std::size_t column) {
                    return scaled(weights[channel * taps + row * C.kernel.columns + column]);
                },
                one_packed.data());
            one::run(one_packed.data(), biased ? bias.data() + channel : nullptr,
                     input.data() + channel * C.input.area() * width,
                     expected.data() + channel * C.output.area() * width, nullptr);
        }
        CHECK(found == expected);
    }
}

template <batch_convolution C, class T>
void compare_gradient() {
    using method = depthwise_gradient<C, T>;
    using one = direct_gradient<C.one_group(), T>;
    static_assert(std::is_same_v<weight_gradient<C, T>, method>);
    constexpr std::size_t width = lanes<T>, taps = C.kernel.area();
    auto input = support::whole_numbers<T>(C.input.size() * width, 7919);
    const auto gradient = support::whole_numbers<T>(C.output.size() * width, 104729);
    for (T& x : input)
        x /= T{7};
    aligned_vector<double> found(method::totals, 0.5), by_pieces(found), expected(found);
    for (std::size_t channel = 0; channel < C.input.channels; ++channel)
        one::add(input.data() + channel * C.input.area() * width,
                 gradient.data() + channel * C.output.area() * width, expected.data() + channel * taps,
                 nullptr, 0, one::pieces);
    method::add(input.data(), gradient.data(), found.data(), nullptr, 0, method::pieces);
    CHECK(found == expected);
    for (std::size_t piece = 0; piece < method::pieces; ++piece)
        method::add(input.data(), gradient.data(), by_pieces.data(), nullptr, piece, piece + 1);
    CHECK(by_pieces == expected);
    aligned_vector<T> gradients(C.weights());
    method::finish(found.data(), gradients.data());
    for (std::size_t w = 0; w < gradients.size(); ++w)
        CHECK(gradients[w] == static_cast<T>(expected[w]));
}

template <class T, shape Input, extent2d Kernel, extent2d Stride = 1, padding Padding = padding::same>
void compare() {
    constexpr auto window = sliding_window::over(Input, Kernel, Stride, Padding);
    constexpr auto ahead = batch_convolution::forward(window, Input.channels, Input.channels),
                   back = batch_convolution::backward(window, Input.channels, Input.channels);
    compare_convolution<ahead, T>();
    if constexpr (Stride == extent2d(1))
        compare_convolution<back, T>();
    else // pixels of the gradient lie apart
        CHECK_FALSE(depthwise_lane_method<back, T>::applicable);
    compare_gradient<ahead, T>();
}

} // namespace

TEST_CASE_TEMPLATE("depthwise_lane_method: the bits of each channel by itself, and its weight gradient", T,
                   float, double) {
    compare<T, shape{14, 25, 3}, 3>();
    compare<T, shape{5, 4, 2}, 3, 2>();
    compare<T, shape{7, 9, 2}, extent2d(5, 4)>();
    compare<T, shape{6, 30, 2}, extent2d(2, 7), extent2d(1, 3), pad(1, 0, 2, 3)>();
    compare<T, shape{1, 1, 3}, 3>();
    compare<T, shape{9, 3, 2}, 3, 1, padding::valid>();
    compare<T, shape{40, 60, 1}, 3>(); // in several tiles of rows
}
TEST_CASE("depthwise_lane_method: several filters for each channel go group by group") {
    constexpr auto window = sliding_window::over(shape{5, 6, 4}, 3, 1, padding::same);
    constexpr auto doubled = batch_convolution::forward(window, 8, 4);
    CHECK_FALSE(depthwise_lane_method<doubled, float>::applicable);
    CHECK(std::is_same_v<lane_convolution<doubled, float>, separate_groups_lane_method<doubled, float>>);
}
