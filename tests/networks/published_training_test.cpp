#include <tactnet/networks.hpp>
#include <tactnet/networks/published_training.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

TEST_CASE("published_training: as in the authors' programs") {
    const auto is = [](const published_training& found, double rate, double drop_period,
                       std::size_t patience) {
        CHECK(found.rate == rate);
        CHECK(found.drop_period == drop_period);
        CHECK(found.patience == patience);
    };
    is(tactnet4_training, 0.05, 200, 3);
    is(tactnet6_training, 0.01, 150, 4);
    is(tactnet6_economical_training, 0.01, 150, 4);
    is(tactresnet_training, 0.002, 0, 5);
}
