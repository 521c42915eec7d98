#include "networks.hpp"

#include <doctest/doctest.h>

#include <array>

// Steps in 8 bits that the networks for tactile images have not, against plain loops in whole numbers: every
// bit of small networks.

using namespace tactnet;
using support::frames_that_differ;

namespace {

template <std::size_t Groups>
inline constexpr conv2d_options grouped{.groups = Groups, .bias = false};

} // namespace

TEST_CASE("eight_bit: strides, pads and channels that fill no vector give the bits of the plain reference") {
    using uneven = network<shape{11, 9, 3}, conv2d<5, extent2d(3, 2), extent2d(2, 1), pad(1)>, relu,
                           conv2d<33, 2, 1, padding::valid>, batch_norm,
                           conv2d<7, extent2d(1, 4), 3, padding::same>, dense<9>>;
    CHECK(frames_that_differ<uneven>(11, 20) == 0);
    using one_channel = network<shape{8, 9}, conv2d<1, 3>, relu, conv2d<2, 4>, max_pool<extent2d(2, 3)>, relu,
                                conv2d<3, 7>, conv2d<5, 1>, dense<1>>;
    CHECK(frames_that_differ<one_channel>(12, 20) == 0);
}

TEST_CASE("eight_bit: pools and ReLUs by themselves give the bits of the plain reference") {
    using pools = network<shape{13, 12, 2}, conv2d<6, 3>, max_pool<3, 2>, relu, max_pool<2, 1, pad(1)>,
                          conv2d<20, 3>, batch_norm, max_pool<3, 1, padding::valid>, relu,
                          average_pool<extent2d(2, 3), 2, pad(1)>, conv2d<4, 1>, global_max_pool, dense<5>>;
    CHECK(frames_that_differ<pools>(13, 20) == 0);
}

namespace {

/// An activation that no layer of the library has: x ÷ (1 + |x|) + Shift ÷ 100.
template <unsigned Shift>
struct shifted_softsign {
    static constexpr const char *name = "softsign", *title = "Softsign", *type = "shifted_softsign",
                                *header = "";
    static constexpr std::array arguments{Shift};
    static constexpr bool moves_zero = Shift > 0;
    template <class T>
    static constexpr T shift = static_cast<T>(Shift) / 100;
    template <class T>
    static constexpr T value(T x) {
        return x / (1 + (x < 0 ? -x : x)) + shift<T>;
    }
    template <class T>
    static constexpr T backward(T y, T gradient) {
        const T rest = 1 - (y < shift<T> ? shift<T> - y : y - shift<T>);
        return gradient * rest * rest;
    }
};

} // namespace

TEST_CASE("eight_bit: activations by a table give the bits of the plain reference") {
    using activations =
        network<shape{7, 9, 2}, conv2d<5, 3>, activation<shifted_softsign<0>>, conv2d<6, 3>, batch_norm,
                activation<shifted_softsign<25>>, max_pool<2>, conv2d<3, 2>, relu, dense<4>>;
    CHECK(frames_that_differ<activations>(35, 20) == 0);
}

TEST_CASE("eight_bit: batch norms that no convolution takes up give the bits of the plain reference") {
    using norms = network<shape{6, 7, 3}, batch_norm, conv2d<6, 3>, relu, batch_norm, relu,
                          conv2d<5, 3, 2, padding::valid>, max_pool<2, 1>, batch_norm, dense<4>>;
    CHECK(frames_that_differ<norms>(14, 40) == 0);
}

TEST_CASE("eight_bit: residual blocks give the bits of the plain reference") {
    using blocks =
        network<shape{8, 10, 2}, conv2d<12, 3>, residual<sequence<conv2d<12, 3>, batch_norm>>, relu,
                residual<sequence<conv2d<9, 3>, relu, conv2d<20, 3>>, sequence<conv2d<20, 1>, batch_norm>>,
                residual<sequence<conv2d<20, 3>>>, relu, max_pool<2>, dense<5>>;
    CHECK(frames_that_differ<blocks>(15, 20) == 0);
    // The sensor's words go into both branches.
    using first =
        network<shape{6, 7, 2}, residual<sequence<conv2d<8, 3>, relu, conv2d<8, 3>>, sequence<conv2d<8, 1>>>,
                relu, dense<3>>;
    CHECK(frames_that_differ<first>(16, 20) == 0);
}

TEST_CASE("eight_bit: concatenations and groups give the bits of the plain reference") {
    using branches =
        network<shape{9, 8, 2}, conv2d<8, 3>, relu,
                concatenation<sequence<conv2d<4, 1>, relu>, sequence<conv2d<3, 1>, relu, conv2d<16, 3>, relu>,
                              sequence<max_pool<3, 1, padding::same>, conv2d<12, 1>>>,
                conv2d<8, 3, 1, padding::same, conv2d_options{.groups = 4}>, relu,
                conv2d<6, 3, 2, pad(1), conv2d_options{.groups = 2, .bias = false}>, max_pool<2>, dense<5>>;
    CHECK(frames_that_differ<branches>(17, 20) == 0);
}

TEST_CASE("eight_bit: depthwise convolutions give the bits of the plain reference") {
    using separable =
        network<shape{11, 9}, conv2d<12, 3>, batch_norm, relu, conv2d<12, 3, 1, padding::same, grouped<12>>,
                batch_norm, relu, conv2d<20, 1>, relu, conv2d<20, 3, 2, padding::same, grouped<20>>,
                batch_norm, relu, conv2d<70, 1>, relu, conv2d<70, extent2d(3, 2), 1, pad(1), grouped<70>>,
                max_pool<2>, relu, dense<5>>;
    CHECK(frames_that_differ<separable>(23, 20) == 0);
    // From the sensor's words, in a residual block, a branch and at the end.
    using placed =
        network<shape{8, 9, 3}, conv2d<3, 3, 1, padding::same, grouped<3>>, relu, conv2d<8, 1>,
                residual<sequence<conv2d<8, 1>, relu, conv2d<8, 5, 1, padding::same, grouped<8>>>>, relu,
                concatenation<sequence<conv2d<4, 1>, relu>, conv2d<8, 3, 1, padding::same, grouped<8>>>, relu,
                conv2d<12, 3, extent2d(2, 3), padding::valid, grouped<12>>>;
    CHECK(frames_that_differ<placed>(24, 20) == 0);
}

TEST_CASE("eight_bit: the last step may be a convolution, with ReLU and pool, or an average pool") {
    CHECK(frames_that_differ<network<shape{7, 6, 3}, conv2d<6, 3>, relu, conv2d<5, 3>>>(18, 20) == 0);
    CHECK(frames_that_differ<network<shape{7, 6, 3}, conv2d<6, 3>, relu, conv2d<5, 3>, max_pool<2>, relu>>(
              19, 20) == 0);
    CHECK(frames_that_differ<network<shape{7, 6}, conv2d<6, 3>, average_pool<3, 2>>>(20, 20) == 0);
    CHECK(frames_that_differ<network<shape{7, 6}, conv2d<6, 3>, relu, adaptive_average_pool<1>>>(21, 20) ==
          0);
    // The only one: it reads the sensor's words and writes floats.
    CHECK(frames_that_differ<network<shape{5, 4, 2}, dense<7>>>(22, 20) == 0);
}

TEST_CASE("eight_bit: square roots of counts and of maps give the bits of the plain reference") {
    using roots = network<shape{9, 7}, square_root<std::ratio<3, 8>>, conv2d<6, 3>, batch_norm, square_root<>,
                          conv2d<5, 2>, relu, dense<3>>;
    CHECK(frames_that_differ<roots>(31, 40) == 0);
}

TEST_CASE("eight_bit: a softmax at the end gives the probabilities of the plain reference") {
    CHECK(frames_that_differ<network<shape{7, 6}, conv2d<6, 3>, relu, dense<4>, softmax>>(32, 20) == 0);
    CHECK(frames_that_differ<network<shape{7, 6}, conv2d<5, 3>, relu, conv2d<3, 2>, softmax>>(33, 20) == 0);
    // Lists inside lists.
    CHECK(frames_that_differ<
              network<shape{7, 6}, conv2d<6, 3>, sequence<relu, sequence<average_pool<3, 2>>, softmax>>>(
              34, 20) == 0);
}
