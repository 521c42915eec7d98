#include <tactnet/training/schedule.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

TEST_CASE("rate_at: constant and step drop") {
    CHECK(rate_at(schedule(constant_rate{}), 0.05, 99.5, 100) == 0.05);
    const schedule drop = step_drop{.period = 200, .factor = 0.1};
    CHECK(rate_at(drop, 0.05, 0, 1000) == 0.05);
    CHECK(rate_at(drop, 0.05, 199.9, 1000) == 0.05);
    CHECK(rate_at(drop, 0.05, 200, 1000) == doctest::Approx(0.005));
    CHECK(rate_at(drop, 0.05, 400, 1000) == doctest::Approx(0.0005));
}

TEST_CASE("rate_at: one cycle") {
    const schedule cycle = one_cycle{.warm_up = 0.25};
    CHECK(rate_at(cycle, 0.01, 0, 80) == doctest::Approx(0.01 / 25));
    CHECK(rate_at(cycle, 0.01, 10, 80) == doctest::Approx(0.01 * (1 + 1.0 / 25) / 2));
    CHECK(rate_at(cycle, 0.01, 20, 80) == doctest::Approx(0.01));
    CHECK(rate_at(cycle, 0.01, 50, 80) == doctest::Approx(0.005).epsilon(1e-4));
    CHECK(rate_at(cycle, 0.01, 80, 80) == doctest::Approx(1e-8));
    CHECK(rate_at(one_cycle{}, 0.01, 20, 80) == doctest::Approx(0.01)); // a quarter by default
    double before = 0;
    for (double epoch = 0; epoch <= 80; epoch += 0.5) { // up, then down
        const double rate = rate_at(cycle, 0.01, epoch, 80);
        CHECK((epoch <= 20 ? rate >= before : rate <= before));
        before = rate;
    }
}
