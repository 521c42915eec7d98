// expect: conv2d: the kernel is larger than the padded input; kernel_fits_padded_input shows kernel rows, kernel columns, padded rows, padded columns
// expect: PaddedRows = 4; KernelRows = 5|kernel_fits_padded_input<5UL, 3UL, 4UL, 9UL>
// at-most: 1
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{4, 9, 1},
                             tactnet::conv2d<8, tactnet::extent2d{5, 3}, 1, tactnet::padding::valid>,
                             tactnet::relu, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
