#include <tactnet/networks/tactresnet.hpp>

#include <networks/learns.hpp>

using namespace tactnet;

// The smallest and the largest size, odd ones, and one between two published resolutions.
TEST_CASE_TEMPLATE("tactresnet: learns at any size", Network, tactresnet<shape{7, 13, 1}, 5>,
                   tactresnet<shape{8, 13, 1}, 5>, tactresnet<shape{13, 29, 1}, 5>,
                   tactresnet<shape{28, 50, 1}, 5>, tactresnet<shape{11, 50, 1}, 5>) {
    support::check_learns<Network>();
}
