#include "comparison.hpp"

#include <doctest/doctest.h>

// Inputs of 16 bits with a sign, as a network in 8 bits reads them from a sensor.

using namespace integer_test;

TEST_CASE("direct_integer_method: words and kernels of 1 to 7 give the sums of plain loops") {
    CHECK(direct_differing<std::int16_t, of({5, 6, 1}, 1, 1), of({5, 6, 1}, 8, 3), of({6, 7, 2}, 3, 2),
                           of({6, 5, 3}, 5, 4), of({7, 6, 4}, 12, 5), of({7, 9, 5}, 16, 6),
                           of({8, 9, 1}, 40, 7)>() == 0);
    CHECK(direct_differing<std::int16_t, of({9, 8, 3}, 7, 3, 2), of({9, 8, 1}, 9, 5, extent2d(2, 3), pad(2)),
                           of({5, 6, 3}, 5, 3, 1, padding::same, 4),
                           of({4, 5, 1}, 8, 2, 1, padding::valid, 16)>() == 0);
}

TEST_CASE("direct_integer_method: words with pools, sums and wider maps") {
    CHECK(direct_differing<std::int16_t, pooled(of({8, 6, 1}, 8, 5), 2, 4, 3),
                           pooled(of({7, 9, 2}, 16, 3), 2, 4, 5), adding(of({5, 7, 4}, 8, 3)),
                           among(of({4, 5, 4}, 8, 3), 32, 16)>() == 0);
}

TEST_CASE("direct_integer_method: the largest words and weights neither overflow nor saturate on the way") {
    for (const numbers_are kind : {numbers_are::largest, numbers_are::smallest}) {
        CHECK(direct_differing<std::int16_t, of({6, 7, 1}, 8, 5)>(kind) == 0);
        CHECK(direct_differing<std::int16_t, of({4, 4, 3}, 16, 3)>(kind) == 0);
        CHECK(direct_differing<std::int16_t, of({5, 5, 2}, 5, 2)>(kind) == 0);
    }
}
