// expect: dropout: the percentage must be below 100
// at-most: 1
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::dropout<100>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
