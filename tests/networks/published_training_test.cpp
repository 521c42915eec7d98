#include <tactnet/networks.hpp>
#include <tactnet/networks/published.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

namespace {

void check(const published_training& found, double rate, double drop_period, double drop_factor,
           std::size_t validate_every, std::size_t patience) {
    CHECK(found.rate == rate);
    CHECK(found.drop_period == drop_period);
    CHECK(found.drop_factor == drop_factor);
    CHECK(found.validate_every == validate_every);
    CHECK(found.patience == patience);
}

} // namespace

TEST_CASE("published_training: as in the authors' programs at 28 x 50") {
    constexpr shape whole{28, 50};
    check(tactnet4_training(whole), 0.05, 200, 0.1, 10, 3);
    check(tactnet6_training(whole), 0.01, 150, 0.1, 10, 4);
    check(tactresnet_training(whole), 0.002, 0, 0.1, 10, 5);
    CHECK(tactnet4_training(whole).subtracts_mean);
    CHECK(tactnet6_training(whole).subtracts_mean);
    CHECK(!tactresnet_training(whole).subtracts_mean);
}

TEST_CASE(
    "published_training: TactNet-6 as in the authors' programs at their lower resolutions, either form") {
    for (const auto of : {tactnet6_training, tactnet6_economical_training}) {
        check(of({20, 35}), 0.1, 100, 0.7, 15, 5);
        check(of({14, 25}), 0.1, 100, 0.7, 15, 7);
        check(of({10, 18}), 0.008, 150, 0.7, 15, 7);
        check(of({7, 13}), 0.008, 150, 0.7, 15, 7);
        check(of({28, 50}), 0.01, 150, 0.1, 10, 4);
    }
}
