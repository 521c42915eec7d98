#include <tactnet/kernels/frame/methods.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <support/frame_convolution.hpp>
#include <type_traits>

using namespace tactnet;
using namespace tactnet::kernels;
using support::adding;
using support::pooled;
using support::with_relu;

namespace {

constexpr frame_convolution step(shape in, extent2d kernel, std::size_t filters_per_channel,
                                 std::size_t input_stride, extent2d stride = 1,
                                 padding around = padding::same) {
    frame_convolution c =
        support::step(in, kernel, filters_per_channel * in.channels, input_stride, stride, around);
    c.groups = in.channels;
    return c;
}

/// Every output is held to the bound of its error, channel by channel.
template <frame_convolution C>
void compare(std::uint64_t seed) {
    CAPTURE(seed);
    using method = depthwise_method<C>;
    // Without vectors, groups one by one need no copy.
    static_assert(std::is_same_v<convolution_method<C>, method> || (method::copied && C.separable_groups()));
    support::convolution_numbers(C, 1, seed).check<method>();
}

} // namespace

TEST_CASE("depthwise_method: any number of channels, kernels and strides") {
    compare<step({14, 25, 64}, 3, 1, 64)>(1);
    compare<with_relu(step({7, 13, 6}, 3, 1, 16))>(2);
    compare<step({5, 4, 3}, extent2d(3, 5), 1, 16)>(3);
    compare<with_relu(step({9, 11, 33}, 3, 1, 48, 2))>(4);
    compare<step({9, 10, 20}, extent2d(4, 1), 1, 32, extent2d(1, 3))>(5);
    compare<step({6, 6, 17}, 3, 1, 32, 1, padding::valid)>(6);
    compare<step({1, 2, 8}, 5, 1, 8)>(7);
    compare<step({40, 50, 40}, 3, 1, 48)>(8);
    compare<step({9, 30, 16}, 7, 1, 16, 1, pad(3, 0, 2, 1))>(9);
}

TEST_CASE("depthwise_method: pools, and sums") {
    compare<pooled(step({7, 13, 24}, 3, 1, 32), 2)>(1);
    compare<pooled(step({8, 9, 5}, 3, 1, 16), extent2d(3, 2))>(2);
    compare<pooled(step({11, 9, 8}, 3, 1, 8, 2), extent2d(2, 3))>(5);
    compare<pooled(step({13, 9, 20}, extent2d(5, 2), 1, 32, extent2d(1, 2)), 2)>(6);
    compare<adding(step({7, 13, 24}, 3, 1, 32))>(3);
    compare<adding(step({9, 7, 8}, extent2d(2, 3), 1, 8, extent2d(3, 2)))>(7);
    compare<adding(step({5, 4, 9}, 3, 1, 16), true)>(4);
}

TEST_CASE("depthwise_method: pixels without gaps and several filters per channel are copied first") {
    compare<step({5, 7, 7}, 3, 1, 7)>(1);
    compare<step({5, 7, 13}, 3, 2, 16)>(2);
    compare<pooled(step({6, 8, 10}, 3, 3, 10), 2)>(3);
    compare<step({5, 7, 3}, 3, 5, 3, 2)>(4);
}

TEST_CASE("depthwise_method: as many weights as taps, one multiply-add for each") {
    constexpr frame_convolution c = step({14, 25, 64}, 3, 1, 64);
    CHECK(convolution_method<c>::packed_elements == 9 * 64 + 64);
    CHECK(convolution_method<c>::workspace_elements == 0);
    // 3 × 3 taps of 14 × 25 pixels, without those on padding.
    CHECK(convolution_method<c>::product_twentieths == 20 * (3 * 14 - 2) * (3 * 25 - 2) * c.vectors());
}
