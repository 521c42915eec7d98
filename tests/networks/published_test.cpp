#include <tactnet/networks.hpp>
#include <tactnet/networks/published.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <utility>

using namespace tactnet;

namespace {

constexpr std::pair<shape, published_resolution> published[] = {{{7, 13}, published_resolution::r7x13},
                                                                {{10, 18}, published_resolution::r10x18},
                                                                {{14, 25}, published_resolution::r14x25},
                                                                {{20, 35}, published_resolution::r20x35},
                                                                {{28, 50}, published_resolution::r28x50}};

} // namespace

TEST_CASE("published_resolution_of: up to a published size in both directions its form, a tactel more the "
          "next one") {
    for (std::size_t i = 0; i < 5; ++i) {
        const shape size = published[i].first;
        const published_resolution form = published[i].second;
        const published_resolution next = published[i < 4 ? i + 1 : 4].second;
        CAPTURE(size.rows);
        CHECK(published_resolution_of(size) == form);
        CHECK(published_resolution_of({size.rows, 1}) == form);
        CHECK(published_resolution_of({1, size.columns}) == form);
        CHECK(published_resolution_of({size.rows + 1, size.columns}) == next);
        CHECK(published_resolution_of({size.rows, size.columns + 1}) == next);
    }
}

TEST_CASE("within_published_range: from 7 x 13 to 28 x 50, either way up") {
    for (std::size_t rows = 5; rows <= 52; ++rows)
        for (std::size_t columns = 5; columns <= 52; ++columns) {
            CAPTURE(rows);
            CAPTURE(columns);
            const bool lying = rows >= 7 && rows <= 28 && columns >= 13 && columns <= 50;
            const bool standing = columns >= 7 && columns <= 28 && rows >= 13 && rows <= 50;
            CHECK(within_published_range({rows, columns}) == (lying || standing));
        }
}

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
