#include <tactnet/simulation/effects/film/drift.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::drift;

namespace {

constexpr shape one{1, 1};

double rate_of(std::uint64_t sensor, double deviation) {
    return drift::bound<one>(drift{deviation}, {.unit = {sensor}}).rate();
}

} // namespace

TEST_CASE("drift: rates of sensors are normal with the given deviation") {
    constexpr int n = 20000;
    double sum = 0, squares = 0;
    for (std::uint64_t sensor = 0; sensor < n; ++sensor) {
        const double rate = rate_of(sensor, 1e-5) / 1e-5;
        sum += rate, squares += rate * rate;
    }
    CHECK(std::abs(sum / n) < 5 / std::sqrt(n));
    CHECK(std::abs(squares / n - 1) < 5 * std::sqrt(2.0 / n));
    CHECK(rate_of(3, 1e-5) == rate_of(3, 1e-5));
}
TEST_CASE("drift: even with time, from the touch on") {
    const drift::bound<one> bound(drift{1e-5}, {.unit = {4}});
    for (const double seconds : {0.0, 100.0, 1000.0}) {
        auto value = support::filled<one>(1000);
        bound.apply(value.view(), {.seconds = seconds});
        CHECK(static_cast<double>(value.data()[0]) ==
              doctest::Approx(1000 * (1 + rate_of(4, 1e-5) * seconds)).epsilon(1e-6));
    }
    REQUIRE(rate_of(4, 1) != 0);
}
TEST_CASE("drift: zero and impossible strength changes no bit, and finite readings never give NaN") {
    constexpr shape size{5, 7};
    support::check_changes_no_bit<size>(drift{0});
    support::check_changes_no_bit<size>(drift{-1});
    support::check_changes_no_bit<size>(drift{std::numeric_limits<double>::quiet_NaN()});
    support::check_no_nan<size>(drift{});
    support::check_no_nan<size>(drift{1e300});
}
