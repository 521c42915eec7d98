// expect: in this number format a network cannot begin with a residual block that passes its input on
// at-most: 3
#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/quantisation/calibration.hpp>

using net = tactnet::network<tactnet::shape{4, 4, 2},
                             tactnet::residual<tactnet::sequence<tactnet::conv2d<2, 3>>>, tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
