// expect: deploy: the main branch of a residual block must end in a convolution, with or without batch norm
// at-most: 1
// characters: 30000
#include <tactnet/deployment.hpp>
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>,
                             tactnet::residual<tactnet::sequence<tactnet::conv2d<8, 3>, tactnet::relu>>,
                             tactnet::dense<22>>;
const auto made = tactnet::deploy(net{});
