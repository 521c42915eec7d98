// expect: pool: the padding must be smaller than the window, or a window holds no pixel; every_window_holds_a_pixel shows rows and columns of padding on one side, window rows, window columns
// expect: WindowRows = 2; PaddingRows = 2|every_window_holds_a_pixel<2UL, 2UL, 2UL, 2UL>
// expect: max_pool<
// at-most: 1
#include <tactnet/networks.hpp>

using net =
    tactnet::network<tactnet::shape{7, 13, 1}, tactnet::max_pool<2, 1, tactnet::pad(2)>, tactnet::dense<3>>;
constexpr auto parameters = net::parameters;
