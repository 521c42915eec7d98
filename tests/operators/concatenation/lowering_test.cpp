#include "../../deployment/deployed_network.hpp"

#include <doctest/doctest.h>

#include <ratio>
#include <type_traits>

// Groups, branches side by side, averages and local responses: what the networks for ImageNet are made of, at
// sizes that fill no vector and at sizes that do.

using namespace tactnet;

TEST_CASE("deployed: groups whose filters fill vectors, groups that do not, convolutions without bias") {
    using net = network<shape{7, 8, 4}, conv2d<32, 3, 1, padding::same, in_groups(2)>, relu, //
                        conv2d<64, 3, 1, padding::same, conv2d_options{.groups = 2, .bias = false}>,
                        batch_norm, relu, //
                        conv2d<6, 3, 2, pad(1), in_groups(2)>, conv2d<6, 3, 1, padding::same, in_groups(6)>,
                        conv2d<5, 1, 1, padding::same, without_bias>, dense<3>>;
    CHECK(support::errors_of<net>(41, 5));
}

TEST_CASE(
    "deployed: depthwise convolutions: pools, strides, sums, several filters per channel, frame and slices") {
    using separable =
        sequence<conv2d<24, 3, 1, padding::same, in_groups(24)>, batch_norm, relu, conv2d<24, 1>>;
    using net = network<shape{11, 9, 3}, conv2d<6, 3, 1, padding::same, in_groups(3)>, conv2d<24, 1>,
                        batch_norm, relu, conv2d<24, extent2d{5, 3}, 1, padding::same, in_groups(24)>, relu,
                        max_pool<2>, residual<separable>, relu,
                        residual<sequence<conv2d<24, 1>, conv2d<24, 3, 1, padding::same, in_groups(24)>>>,
                        relu, concatenation<conv2d<24, 3, 1, padding::same, in_groups(24)>, identity_layer>,
                        relu, conv2d<48, 3, 2, padding::same, in_groups(48)>, dense<4>>;
    CHECK(support::errors_of<net>(50, 5));
}

TEST_CASE("deployed: branches that write side by side, and branches that are copied there") {
    using fire = sequence<conv2d<8, 1>, relu,
                          concatenation<sequence<conv2d<16, 1>, relu>, sequence<conv2d<32, 3>, relu>>>;
    using mixed = concatenation<identity_layer, sequence<conv2d<5, 3>, relu, max_pool<3, 1>>, dropout<30>,
                                sequence<conv2d<12, 3>, batch_norm, relu>, conv2d<3, 1>>;
    using net = network<shape{9, 7, 3}, fire, max_pool<3, 2, ceil_mode()>, fire, mixed, relu,
                        concatenation<mixed, max_pool<3, 1>>, dense<4>>;
    CHECK(support::errors_of<net>(42, 5));
}

TEST_CASE("deployed: a branch of several steps keeps out of the maps around it") {
    // Maps that fill their memory, to either side of it.
    using several = concatenation<identity_layer, sequence<conv2d<32, 3>, relu, max_pool<3, 1>>>;
    using once = network<shape{5, 7, 3}, conv2d<32, 3>, several, dense<4>>;
    using behind = network<shape{5, 7, 3}, conv2d<64, 3>, conv2d<32, 3>, several, dense<4>>;
    CHECK(support::errors_of<once>(48, 5));
    CHECK(support::errors_of<behind>(49, 5));
}

TEST_CASE("deployed: branches in groups, as the first layer and as the last") {
    using net =
        network<shape{5, 6, 4}, concatenation<conv2d<8, 3, 1, padding::same, in_groups(2)>, identity_layer>,
                concatenation<conv2d<16, 1, 1, padding::same, in_groups(4)>, conv2d<2, 3>>>;
    CHECK(support::errors_of<net>(43, 5));
}

TEST_CASE("deployed: averages of windows, of bins and of everything") {
    using net =
        network<shape{9, 11, 3}, average_pool<2>, conv2d<20, 3>, relu,        //
                average_pool<3, 2, pad(1), average_over::pixels_and_padding>, //
                conv2d<5, 3>, adaptive_average_pool<extent2d{2, 5}>, conv2d<9, 1>, global_average_pool>;
    CHECK(support::errors_of<net>(44, 5));
}

TEST_CASE("deployed: local responses, of channels that fill no vector too") {
    using strong = local_response_norm<5, std::ratio<2>>;
    using net = network<shape{5, 6, 3}, strong, conv2d<20, 3>, relu, strong, conv2d<16, 3>,
                        local_response_norm<4, std::ratio<1>, std::ratio<4, 5>, std::ratio<2>>, dense<3>>;
    CHECK(support::errors_of<net>(45, 5));
}

TEST_CASE("deployed: square roots, of the counts and between layers, of elements that fill no vector too") {
    using net = network<shape{5, 7}, square_root<std::ratio<3, 8>>, conv2d<5, 3>, square_root<>, dense<3>>;
    CHECK(support::errors_of<net>(47, 5));
}

TEST_CASE("deployed: max pools in ceil mode") {
    using net = network<shape{8, 11, 2}, conv2d<8, 3>, relu, max_pool<2, 2, ceil_mode()>, //
                        conv2d<5, 3>, max_pool<3, 2, ceil_mode(pad(1))>, dense<3>>;
    CHECK(support::errors_of<net>(46, 5));
}

// A name changes no step, and neither does the place in a list: what repeats is compiled once.
using repeated_block = sequence<residual<conv2d<16, 3>>, relu>;
using repeated = lowered_network<network<shape{6, 6, 16}, conv2d<16, 1>, named<"layer1.0", repeated_block>,
                                         named<"layer1.1", repeated_block>>>::step;
static_assert(std::is_same_v<repeated::at<1>, repeated::at<2>>);
