#include <tactnet/networks/tactnet6.hpp>

#include <networks/learns.hpp>

using namespace tactnet;

// The smallest and the largest size, odd ones, and one between two published resolutions.
TEST_CASE_TEMPLATE("tactnet6: learns at any size", Network, tactnet6<shape{7, 13, 1}, 5>,
                   tactnet6<shape{8, 13, 1}, 5>, tactnet6<shape{13, 29, 1}, 5>, tactnet6<shape{28, 50, 1}, 5>,
                   tactnet6<shape{11, 50, 1}, 5>) {
    support::check_learns<Network>();
}
