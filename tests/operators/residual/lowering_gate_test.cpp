#include "../../deployment/deployed_network.hpp"
#include "../../deployment/eight_bit/networks.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <type_traits>

using namespace tactnet;

namespace {

using once = network<shape{7, 9, 3}, conv2d<20, 3>, squeeze_excitation<20, 4>>;
/// Of maps that fill vectors and maps that do not, with branches of all kinds.
using gated = network<shape{7, 9, 3}, squeeze_excitation<3, 2>, conv2d<16, 3>, batch_norm, relu,
                      squeeze_excitation<16, 4, hard_sigmoid>, conv2d<20, 3>, relu,
                      gate<global_max_pool, conv2d<20, 1>, batch_norm, hyperbolic_tangent>, max_pool<2>,
                      gate<global_average_pool>, dense<4>>;
using inverted = residual<
    sequence<conv2d<24, 1>, batch_norm, hard_swish, conv2d<24, 3, 1, padding::same, in_groups(24)>,
             batch_norm, hard_swish, squeeze_excitation<24, 6, hard_sigmoid>, conv2d<12, 1>, batch_norm>>;
/// Blocks of MobileNetV3, and a gate in a branch of a concatenation.
using mobile = network<shape{9, 7, 2}, conv2d<12, 3, 2>, hard_swish, inverted, inverted,
                       concatenation<sequence<squeeze_excitation<12, 3>, conv2d<8, 1>>, conv2d<8, 3>>, relu,
                       squeeze_excitation<16, 3>, dense<5>>;
/// Of a single pixel: by the map itself, and by a dense layer.
using pixel = network<shape{5, 4}, dense<9>, gate<>, gate<dense<9>, sigmoid>, dense<3>>;

} // namespace

TEST_CASE("deployed: gates, of maps that fill vectors and of the frame, in blocks and in branches") {
    CHECK(support::errors_of<once>(70, 5));
    CHECK(support::errors_of<gated>(71, 5));
    CHECK(support::errors_of<mobile>(72, 5));
    CHECK(support::errors_of<pixel>(73, 5));
}

TEST_CASE("deployed: gates with a sigmoid leave the input limit where it is") {
    using plain = network<shape{7, 9}, conv2d<8, 3>, relu, dense<3>>;
    using with_gates = network<shape{7, 9}, conv2d<8, 3>, relu, squeeze_excitation<8, 2>,
                               squeeze_excitation<8, 2, hard_sigmoid>, dense<3>>;
    const auto limit = []<class Network>(std::type_identity<Network>) {
        Network net;
        support::fill(net, 74);
        return deploy(net).folded()[Network::input_shape.size() + 1];
    };
    // Where the sigmoid is part of a block or of a convolution, before a step that moves its outputs.
    using after_blocks =
        network<shape{7, 9}, conv2d<16, 3>, relu, gate<global_average_pool, residual<conv2d<16, 1>>, sigmoid>,
                gate<global_average_pool, transposed_conv2d<16, 1>, sigmoid>, dense<3>>;
    const float without = limit(std::type_identity<plain>{});
    for (const float with :
         {limit(std::type_identity<with_gates>{}), limit(std::type_identity<after_blocks>{})}) {
        CAPTURE(without);
        CAPTURE(with);
        CHECK(with >= without / 1e4F); // the branches' own sums are a little larger
    }
}

TEST_CASE("deployed: gates in 8 bits give the bits of the plain reference") {
    using after_convolution =
        network<shape{7, 9, 3}, conv2d<16, 3>, batch_norm, relu, squeeze_excitation<16, 4, hard_sigmoid>,
                conv2d<20, 3>, relu, gate<global_max_pool, conv2d<20, 1>, hyperbolic_tangent>, max_pool<2>,
                gate<global_average_pool>, dense<4>>;
    CHECK(support::frames_that_differ<after_convolution>(75, 20) == 0);
    CHECK(support::frames_that_differ<mobile>(76, 20) == 0);
    CHECK(support::frames_that_differ<pixel>(77, 20) == 0);
}
