#include "networks.hpp"

#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>

#include <doctest/doctest.h>

// The networks for tactile images in 8 bits, against plain loops in whole numbers: every bit.

using namespace tactnet;
using support::frames_that_differ;

TEST_CASE("eight_bit: TactNet-4, also strided, gives the bits of the plain reference") {
    CHECK(frames_that_differ<tactnet4<shape{7, 13}, 22>>(1, 40) == 0);
    CHECK(frames_that_differ<tactnet4<shape{28, 50}, 22>>(2, 6) == 0);
    CHECK(frames_that_differ<tactnet4_strided<shape{14, 25}, 22>>(7, 10) == 0);
}

TEST_CASE("eight_bit: TactNet-6, also economical, and TactResNet give the bits of the plain reference") {
    CHECK(frames_that_differ<tactnet6<shape{10, 18}, 22>>(3, 4, 1) == 0);
    CHECK(frames_that_differ<tactnet6<shape{28, 50}, 22>>(4, 3, 1) == 0);
    CHECK(frames_that_differ<tactnet6_economical<shape{7, 13}, 22>>(6, 6, 1) == 0);
    CHECK(frames_that_differ<tactresnet<shape{7, 13}, 22>>(5, 2, 1) == 0);
}
