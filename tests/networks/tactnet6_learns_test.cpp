#include <tactnet/networks/tactnet6.hpp>

#include <networks/learns.hpp>

template <tactnet::shape Image>
using network = tactnet::tactnet6<Image, 5>;

TEST_CASE("tactnet6: learns at any size") {
    support::check_learns_at_sizes<network>();
}
