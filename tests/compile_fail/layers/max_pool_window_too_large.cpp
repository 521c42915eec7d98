// expect: pool: the window is larger than the padded input; window_fits_padded_input shows window rows, window columns, padded rows, padded columns
// expect: PaddedColumns = 4; WindowColumns = 5|window_fits_padded_input<5UL, 5UL, 7UL, 4UL>
// expect: max_pool<
// at-most: 1
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{7, 4, 1}, tactnet::conv2d<8, 3>, tactnet::relu,
                             tactnet::max_pool<5, 1, tactnet::padding::valid>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
