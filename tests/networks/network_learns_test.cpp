#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet4_strided.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>

#include <networks/learns.hpp>

namespace {

template <tactnet::shape Image>
using tactnet4 = tactnet::tactnet4<Image, 5>;
template <tactnet::shape Image>
using tactnet4_small = tactnet::tactnet4_small<Image, 5>;
template <tactnet::shape Image>
using tactnet6 = tactnet::tactnet6<Image, 5>;
template <tactnet::shape Image>
using tactresnet = tactnet::tactresnet<Image, 5>;

} // namespace

TEST_CASE("tactnet4: learns at any size") {
    support::check_learns_at_sizes<tactnet4>();
}
TEST_CASE("tactnet4_small: learns at any size") {
    support::check_learns_at_sizes<tactnet4_small>();
}
TEST_CASE("tactnet6: learns at any size") {
    support::check_learns_at_sizes<tactnet6>();
}
TEST_CASE("tactresnet: learns at any size") {
    support::check_learns_at_sizes<tactresnet>();
}
