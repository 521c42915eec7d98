#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>

#include <networks/learns.hpp>

namespace {

template <tactnet::shape Image>
using tactnet4 = tactnet::tactnet4<Image, 5>;
template <tactnet::shape Image>
using tactnet4_strided = tactnet::tactnet4_strided<Image, 5>;
template <tactnet::shape Image>
using tactnet6 = tactnet::tactnet6<Image, 5>;
template <tactnet::shape Image>
using tactresnet = tactnet::tactresnet<Image, 5>;

} // namespace

TEST_CASE("tactnet4: learns at any size") {
    support::check_learns_at_sizes<tactnet4>();
}
TEST_CASE("tactnet4_strided: learns at any size") {
    support::check_learns_at_sizes<tactnet4_strided>();
}
TEST_CASE("tactnet6: learns at any size") {
    support::check_learns_at_sizes<tactnet6>();
}
TEST_CASE("tactresnet: learns at any size") {
    support::check_learns_at_sizes<tactresnet>();
}
