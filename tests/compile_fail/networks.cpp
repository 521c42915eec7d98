#include <tactnet/networks.hpp>

#ifdef CASE_image_too_small
// expect: tactnet4, tactnet6, tactresnet: the image is smaller than the first kernel of 5 x 5 tactels; image_is_large_enough shows its rows and columns, then the least
// expect: LeastRows = 5; Rows = 4|image_is_large_enough<4UL, 9UL, 5, 5>
// at-most: 1
extern tactnet::tactnet4<tactnet::shape{4, 9}, 22> net;
#endif
