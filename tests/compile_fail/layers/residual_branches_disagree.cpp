// expect: residual: both branches must give the same shape; branches_agree shows rows, columns and channels of the main branch, then those of the skip
// expect: SkipChannels = 8; MainChannels = 16|branches_agree<7UL, 13UL, 16UL, 7UL, 13UL, 8UL>
// at-most: 1
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{7, 13, 1}, tactnet::conv2d<8, 3>,
                             tactnet::residual<tactnet::sequence<tactnet::conv2d<16, 3>, tactnet::relu>>,
                             tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
