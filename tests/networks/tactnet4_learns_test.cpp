#include <tactnet/networks/tactnet4.hpp>

#include <networks/learns.hpp>

template <tactnet::shape Image>
using network = tactnet::tactnet4<Image, 5>;

TEST_CASE("tactnet4: learns at any size") {
    support::check_learns_at_sizes<network>();
}
