// expect: in 8 bits a network cannot begin with a pool or a ReLU: a convolution, a dense layer or a batch norm
// at-most: 2
#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/quantisation/calibration.hpp>

using net = tactnet::network<tactnet::shape{8, 8}, tactnet::average_pool<2>, tactnet::conv2d<4, 3>,
                             tactnet::dense<2>>;
constexpr std::size_t bytes = tactnet::deployed<net, tactnet::eight_bit>::weight_bytes;
