#include "deployed_network.hpp"

#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

namespace {

template <class Network>
void check_errors(std::uint64_t seed, std::size_t frames) {
    const support::error_shares errors = support::errors_of<Network>(seed, frames);
    MESSAGE(Network::input_shape.rows << " x " << Network::input_shape.columns << ": " << errors);
    CHECK(errors.good());
}

} // namespace

TEST_CASE_TEMPLATE("deployed: tactnet4, every logit lies within the bound of its error", network,
                   tactnet4<shape{28, 50}, 22>, tactnet4<shape{14, 25}, 22>, tactnet4<shape{7, 13}, 22>) {
    check_errors<network>(4, 3);
}

TEST_CASE_TEMPLATE("deployed: tactnet6, every logit lies within the bound of its error", network,
                   tactnet6<shape{28, 50}, 22>, tactnet6<shape{14, 25}, 22>, tactnet6<shape{7, 13}, 22>) {
    check_errors<network>(6, 3);
}

TEST_CASE("deployed: tactnet4_strided, every logit lies within the bound of its error") {
    check_errors<tactnet4_strided<shape{14, 25}, 22>>(10, 3);
}

TEST_CASE("deployed: tactresnet, every logit lies within the bound of its error") {
    check_errors<tactresnet<shape{28, 50}, 22>>(8, 1);
}
