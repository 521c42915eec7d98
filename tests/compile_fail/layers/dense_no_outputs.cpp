// expect: dense: there must be at least one output
// at-most: 1
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::dense<0>>;
constexpr auto parameters = net::parameters;
