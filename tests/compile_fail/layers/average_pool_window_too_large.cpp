// expect: pool: the window is larger than the padded input; window_fits_padded_input shows window rows, window columns, padded rows, padded columns
// expect: average_pool<
// at-most: 1
#include <tactnet/layers/average_pool.hpp>
#include <tactnet/networks/network.hpp>

using net = tactnet::network<tactnet::shape{7, 13, 6}, tactnet::average_pool<8, 1, tactnet::padding::valid>>;
constexpr auto parameters = net::parameters;
