#include <tactnet/training/early_stopping.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace tactnet;

TEST_CASE("early_stopping: after `patience` checks without a smaller loss") {
    early_stopping stopping(3);
    CHECK(!stopping.check(2));
    CHECK(!stopping.check(1));
    CHECK(!stopping.check(1)); // no better
    CHECK(!stopping.check(5));
    CHECK(!stopping.check(0.5));
    CHECK(stopping.waited() == 0);
    CHECK(!stopping.check(std::numeric_limits<double>::quiet_NaN()));
    CHECK(!stopping.check(0.6));
    CHECK(stopping.check(0.7));
    CHECK(stopping.smallest() == 0.5);

    early_stopping again(3);
    again.restore(0.5, 2);
    CHECK(again.check(0.5));
    early_stopping at_once(1);
    CHECK(!at_once.check(2));
    CHECK(at_once.check(2));
    early_stopping never;
    for (int i = 0; i < 100; ++i)
        CHECK(!never.check(1));
}
