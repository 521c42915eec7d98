#include "../../deployment/deployed_network.hpp"
#include "../../deployment/eight_bit/networks.hpp"

#include <doctest/doctest.h>

#include <cstddef>

// Residual blocks whose main branch cannot add in its last step.

using namespace tactnet;

namespace {

/// Two blocks of the same main branch, with different functions after them.
template <class Main>
using blocks_of =
    network<shape{7, 9, 3}, conv2d<20, 3>, relu, residual<Main>, silu, residual<Main>, relu, dense<4>>;
/// Functions that are not zero at zero, after sums of channels that fill vectors and channels that do not.
template <std::size_t Channels>
using sums_of = network<shape{7, 9, 3}, conv2d<Channels, 3>, residual<relu>, sigmoid,
                        residual<max_pool<3, 1>>, softplus, dense<4>>;

} // namespace

TEST_CASE_TEMPLATE("deployed: residual blocks whose main branch does not end in a convolution", Main,
                   sequence<conv2d<20, 3>, batch_norm, squeeze_excitation<20, 5>>,
                   sequence<conv2d<20, 3>, group_norm<4>>, sequence<conv2d<20, 3>, relu>,
                   dilated_conv2d<20, 3>, sequence<conv2d<20, 1>, max_pool<3, 1>, gelu, dropout<20>>) {
    CHECK(support::errors_of<blocks_of<Main>>(71, 5));
    CHECK(support::frames_that_differ<blocks_of<Main>>(72, 20) == 0); // in 8 bits, from the plain reference
}
TEST_CASE_TEMPLATE("deployed: functions that move zero after residual blocks", Network, sums_of<1>,
                   sums_of<6>, sums_of<16>) {
    CHECK(support::errors_of<Network>(74, 5));
    CHECK(support::frames_that_differ<Network>(75, 20) == 0);
}
TEST_CASE_TEMPLATE("deployed: residual blocks that end in other layers", Main,
                   sequence<conv2d<20, 3>, transposed_conv2d<20, 3, 1, pad(1)>>,
                   sequence<average_pool<3, 1>, named<"inner", sequence<residual<relu>>>>) {
    CHECK(support::errors_of<blocks_of<Main>>(73, 5));
}
