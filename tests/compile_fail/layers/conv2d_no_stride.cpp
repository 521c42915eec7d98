// expect: conv2d: filters, kernel and stride must be at least 1
// at-most: 1
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::conv2d<8, 3, 0>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
