#pragma once

#include "leaky_relu.hpp"

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

namespace own {

/// A small network with the layer in it, also inside a residual block.
using network = tactnet::network<
    tactnet::shape{7, 13, 1},                                                                          //
    tactnet::conv2d<8, 3>, tactnet::batch_norm, leaky_relu<5>, tactnet::max_pool<2>,                   //
    tactnet::residual<tactnet::sequence<tactnet::conv2d<8, 3>, leaky_relu<5>, tactnet::conv2d<8, 3>>>, //
    leaky_relu<5>, tactnet::dense<3>>;

} // namespace own
