// expect: dense_surf: expected one map of at least 2 x 2 tactels
// at-most: 1
#include <tactnet/features.hpp>

constexpr auto descriptors = tactnet::dense_surf<tactnet::shape{1, 1}>::most;
