#include <tactnet/simulation/effects/film/creep.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::creep;

namespace {

double reading(const creep& effect, double seconds) {
    constexpr shape one{1, 1};
    return static_cast<double>(
        support::after<one>(effect, support::filled<one>(1000), {.seconds = seconds}).data()[0]);
}

} // namespace

TEST_CASE("creep: the same share with every decade of time") {
    for (const double time : {0.1, 1.0, 60.0}) {
        const creep effect{.rate = 0.05, .time = time};
        CHECK(reading(effect, 0) == 1000);
        CHECK(reading(effect, 9 * time) == doctest::Approx(1050).epsilon(1e-6));
        CHECK(reading(effect, 99 * time) == doctest::Approx(1100).epsilon(1e-6));
        CHECK(reading(effect, 999 * time) == doctest::Approx(1150).epsilon(1e-6));
    }
}
TEST_CASE("creep: zero strength changes no bit, and finite readings never give NaN or fall below zero") {
    constexpr shape size{5, 7};
    support::check_changes_no_bit<size>(creep{.rate = 0});
    support::check_changes_no_bit<size>(creep{.time = 0});
    support::check_changes_no_bit<size>(creep{.time = -1});
    for (const double rate : {0.05, -9.0, 1e300})
        support::check_no_nan<size>(creep{.rate = rate, .time = 1e-300});
    CHECK(reading({.rate = -9}, 1e6) == 0);
    CHECK(reading({}, -5) == 1000);
    CHECK(reading({}, std::numeric_limits<double>::quiet_NaN()) == 1000);
}
