#include <tactnet/simulation/effects/film/temperature.hpp>

#include <doctest/doctest.h>

#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::temperature;

namespace {

constexpr shape one{1, 1};

} // namespace

TEST_CASE("temperature: the same share with every kelvin") {
    const auto reading = [](double celsius) {
        return static_cast<double>(support::after<one>(temperature{.sensitivity = 0.004, .calibrated = 20},
                                                       support::filled<one>(1000), {.celsius = celsius})
                                       .data()[0]);
    };
    CHECK(reading(20) == 1000);
    CHECK(reading(30) == doctest::Approx(1040).epsilon(1e-6));
    CHECK(reading(-5) == doctest::Approx(900).epsilon(1e-6));
    CHECK(reading(-400) == 0);
}
TEST_CASE("temperature: zero sensitivity changes no bit, and finite readings never give NaN") {
    constexpr shape size{5, 7};
    support::check_changes_no_bit<size>(temperature{.sensitivity = 0});
    support::check_changes_no_bit<size>(temperature{.calibrated = 60}); // the trial's own temperature
    support::check_no_nan<size>(temperature{});
    support::check_no_nan<size>(temperature{.sensitivity = -1e300});
}
