#include "../../deployment/deployed_network.hpp"
#include "../../deployment/eight_bit/networks.hpp"

#include <doctest/doctest.h>

using namespace tactnet;

namespace {

/// Part of the convolution before it, as the last of a main branch too, with the ReLU and the pool after it.
using folded = network<shape{7, 9, 3}, conv2d<20, 3>, channel_scale, max_pool<2>, relu,
                       residual<sequence<conv2d<24, 1>, relu, conv2d<20, 3>, channel_scale>>, relu, dense<4>>;
static_assert(lowered_network<folded>::step::size == 3);
/// A step of its own, after other layers.
using alone = network<shape{7, 9, 3}, channel_scale, conv2d<9, 3>, relu, channel_scale, relu, conv2d<6, 2>,
                      batch_norm, channel_scale, dense<4>, channel_scale, dense<3>>;

} // namespace

TEST_CASE("deployed: channel scales, folded into convolutions and alone") {
    CHECK(support::errors_of<folded>(81, 5));
    CHECK(support::errors_of<alone>(82, 5));
}

TEST_CASE("deployed: channel scales in 8 bits give the bits of the plain reference") {
    CHECK(support::frames_that_differ<folded>(83, 20) == 0);
    CHECK(support::frames_that_differ<alone>(84, 20) == 0);
}
