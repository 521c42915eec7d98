// expect: conv2d: groups must divide the channels of the input and the filters; groups_divide shows groups, channels, filters
// expect: Filters = 8|groups_divide<3UL, 6UL, 8UL>
// at-most: 1
#include <tactnet/layers/conv2d.hpp>
#include <tactnet/networks/network.hpp>

using net = tactnet::network<tactnet::shape{7, 13, 6},
                             tactnet::conv2d<8, 3, 1, tactnet::padding::same, tactnet::in_groups(3)>>;
constexpr auto parameters = net::parameters;
