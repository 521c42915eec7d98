#include "networks.hpp"

#include <doctest/doctest.h>

// Steps in 8 bits that give a map another size, against plain loops in whole numbers: every bit of small
// networks.

using namespace tactnet;
using support::frames_that_differ;

TEST_CASE("eight_bit: adaptive max pools give the bits of the plain reference") {
    using pools = network<shape{13, 12, 2}, conv2d<6, 3>, adaptive_max_pool<extent2d(5, 7)>, relu,
                          conv2d<20, 3>, batch_norm, adaptive_max_pool<extent2d(8, 3)>, relu, conv2d<16, 2>,
                          relu, adaptive_max_pool<extent2d(4, 1)>, dense<5>>;
    CHECK(frames_that_differ<pools>(61, 20) == 0);
}

TEST_CASE("eight_bit: nearest and bilinear upsampling give the bits of the plain reference") {
    using maps = network<shape{5, 6, 2}, conv2d<6, 3>, upsample<2>, conv2d<20, 3>, relu,
                         upsample<extent2d(1, 3), interpolation::bilinear>, max_pool<2, 3>, conv2d<16, 3, 2>,
                         upsample_to<extent2d(7, 5), interpolation::bilinear>, relu, conv2d<3, 1>,
                         upsample_to<extent2d(3, 4)>, dense<5>>;
    CHECK(frames_that_differ<maps>(62, 20) == 0);
    using row = network<shape{1, 6}, conv2d<33, 1>, upsample<4, interpolation::bilinear>, conv2d<2, 3>>;
    CHECK(frames_that_differ<row>(63, 20) == 0);
}

TEST_CASE("eight_bit: transposed convolutions give the bits of the plain reference") {
    using maps = network<shape{3, 4, 2}, transposed_conv2d<5, 3, 2, pad(1, 0, 1, 0)>, batch_norm, relu,
                         conv2d<8, 3, 2>, transposed_conv2d<16, 4, 2>, relu, conv2d<9, 3, 2>,
                         transposed_conv2d<3, 2, extent2d(1, 3)>, transposed_conv2d<4, 3, 1>, dense<5>>;
    CHECK(frames_that_differ<maps>(64, 20) == 0);
}

TEST_CASE("eight_bit: dilated convolutions give the bits of the plain reference") {
    // Inputs below zero, so that zero is a byte in the middle.
    using maps = network<shape{7, 6, 2}, conv2d<6, 3>, dilated_conv2d<5, 3>, batch_norm, relu,
                         dilated_conv2d<16, 3, 3>, dilated_conv2d<8, 2, extent2d(1, 2), 1, pad(1)>,
                         max_pool<2>, dilated_conv2d<8, 3, 2, 1, padding::same, in_groups(8)>, relu,
                         dilated_conv2d<3, 3, 2, 2>, dense<5>>;
    CHECK(frames_that_differ<maps>(65, 20) == 0);
    // Phases of the rows side by side: four, three, and two.
    using side_by_side = network<shape{14, 13, 2}, conv2d<6, 3>, dilated_conv2d<16, 3, 4>, batch_norm, relu,
                                 dilated_conv2d<8, 3, 3, 2>, relu, dilated_conv2d<5, 5, 2>, dense<5>>;
    CHECK(frames_that_differ<side_by_side>(66, 20) == 0);
}
