#include <tactnet/networks/tactresnet.hpp>

#include <networks/learns.hpp>

template <tactnet::shape Image>
using network = tactnet::tactresnet<Image, 5>;

TEST_CASE("tactresnet: learns at any size") {
    support::check_learns_at_sizes<network>();
}
