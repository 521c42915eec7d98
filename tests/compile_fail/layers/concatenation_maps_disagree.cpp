// expect: concatenation: all branches must give the same rows and columns; maps_agree shows those of a branch, then those of the first
// at-most: 1
#include <tactnet/layers/conv2d.hpp>
#include <tactnet/networks/network.hpp>

using net = tactnet::network<tactnet::shape{7, 13, 6},
                             tactnet::concatenation<tactnet::conv2d<8, 3>, tactnet::conv2d<8, 3, 2>>>;
constexpr auto parameters = net::parameters;
