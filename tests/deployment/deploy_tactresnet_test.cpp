#include "deployed_network.hpp"

#include <tactnet/networks/tactresnet.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

TEST_CASE("deployed: tactresnet, every logit lies within the bound of its error") {
    const support::error_shares errors = support::errors_of<tactresnet<shape{28, 50}, 22>>(8, 1);
    MESSAGE("28 x 50: " << errors);
    CHECK(errors.good());
}
