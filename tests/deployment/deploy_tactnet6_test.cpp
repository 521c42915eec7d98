#include "deployed_network.hpp"

#include <tactnet/networks/tactnet6.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

TEST_CASE_TEMPLATE("deployed: tactnet6, every logit lies within the bound of its error", network,
                   tactnet6<shape{28, 50}, 22>, tactnet6<shape{14, 25}, 22>, tactnet6<shape{7, 13}, 22>) {
    const support::error_shares errors = support::errors_of<network>(6, 3);
    MESSAGE(network::input_shape.rows << " x " << network::input_shape.columns << ": " << errors);
    CHECK(errors.good());
}
