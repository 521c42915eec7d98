#include "../deployment/deployed_network.hpp"

#include <doctest/doctest.h>

// What the published networks do not hold: each network here has a few layers that must be taken up in the
// right order, at sizes that fill no vector and no register block.

using namespace tactnet;

TEST_CASE("deployed: filters that fill no vector, even kernels, strides, explicit padding") {
    using net = network<shape{9, 11, 3},                                                          //
                        conv2d<5, extent2d(4, 2), 1>, relu,                                       //
                        conv2d<12, 3, extent2d(2, 1), pad(0, 2, 1, 1)>, batch_norm, relu,         //
                        conv2d<33, 3>, conv2d<3, extent2d(1, 3), extent2d(1, 2), padding::valid>, //
                        conv2d<20, 2>, dense<7>>;
    CHECK(support::errors_of<net>(21, 5));
}

TEST_CASE("deployed: pools that overlap, cut, complete or keep the image, on either side of ReLU") {
    using net = network<shape{13, 17, 2},                                                //
                        conv2d<12, 3>, batch_norm, max_pool<2, 2, padding::valid>, relu, // cut
                        conv2d<8, 3>, relu, max_pool<3, 2>, max_pool<2, 1>,              // overlap, stride 1
                        conv2d<20, 2>, max_pool<2>, max_pool<extent2d(1, 2)>, relu,      // completed, twice
                        batch_norm, global_max_pool, dense<5>>;
    CHECK(support::errors_of<net>(22, 5));
}

TEST_CASE("deployed: batch norm first, after a pool and after dense; softmax last") {
    using net = network<shape{7, 6, 2},                                                     //
                        batch_norm, conv2d<3, 3>, max_pool<3, 1, pad(1)>, batch_norm, relu, //
                        conv2d<1, 3>, dropout<50>, batch_norm, relu,                        //
                        dense<9>, batch_norm, relu, dropout<50>, dense<4>, batch_norm, softmax>;
    CHECK(support::errors_of<net>(23, 5));
}

TEST_CASE("deployed: residual blocks with identity and with projection, lists inside lists") {
    using main = sequence<conv2d<12, 3>, batch_norm, relu, conv2d<12, 3>, batch_norm>;
    using net = network<shape{6, 9}, sequence<conv2d<12, 3>, sequence<batch_norm, relu>>,           //
                        residual<main>, relu, max_pool<2>,                                          //
                        residual<sequence<conv2d<20, 3, 2>, relu, conv2d<20, 2>>,                   //
                                 sequence<conv2d<20, 1, 2>, batch_norm>>,                           //
                        residual<conv2d<20, 3>, sequence<dropout<30>, sequence<dropout<5>>>>, relu, //
                        dense<3>>;
    CHECK(support::errors_of<net>(24, 5));
}

TEST_CASE("deployed: images of one row, of one column and of one pixel") {
    using row =
        network<shape{1, 19}, conv2d<5, 3>, batch_norm, relu, max_pool<2>, conv2d<16, 3>, relu, dense<3>>;
    using column =
        network<shape{19, 1, 3}, conv2d<16, 3>, relu, max_pool<2>, conv2d<8, 2>, max_pool<2>, dense<2>>;
    using pixel = network<shape{1, 1}, conv2d<8, 3>, relu, conv2d<9, 1>, max_pool<2>, dense<1>>;
    CHECK(support::errors_of<row>(25, 5));
    CHECK(support::errors_of<column>(26, 5));
    CHECK(support::errors_of<pixel>(27, 5));
}

TEST_CASE("deployed: a network whose output is an image") {
    using net = network<shape{5, 7}, conv2d<5, 3>, relu, conv2d<3, 1>>;
    CHECK(support::errors_of<net>(28, 5));
}

TEST_CASE("deployed: branches whose pixels lie differently far apart") {
    using on_input = network<shape{6, 6, 1}, residual<conv2d<1, 3>>, relu, dense<3>>;
    using pooled_skip = network<shape{6, 6, 3}, residual<conv2d<3, 3>, max_pool<3, 1>>, dense<3>>;
    using behind_dense = network<shape{3, 3, 1}, dense<22>, residual<conv2d<22, 1>>, dense<3>>;
    CHECK(support::errors_of<on_input>(29, 5));
    CHECK(support::errors_of<pooled_skip>(30, 5));
    CHECK(support::errors_of<behind_dense>(31, 5));
}

TEST_CASE(
    "deployed: tiles whose parts end within a cache line, padding larger than the kernel, large pools") {
    using odd_tiles = network<shape{7, 7, 8}, conv2d<32, 2, 1, padding::valid>, dense<3>>;
    using far_padding = network<shape{4, 4}, conv2d<8, 3, 1, pad(7)>, relu, dense<3>>;
    using large_pool = network<shape{12, 12}, conv2d<16, 3>, relu, max_pool<6>, dense<3>>;
    CHECK(support::errors_of<odd_tiles>(32, 5));
    CHECK(support::errors_of<far_padding>(33, 5));
    CHECK(support::errors_of<large_pool>(34, 5));
}
