#include <tactnet/simulation/effects/film/linearity.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::linearity;

TEST_CASE("linearity: right at both ends, and at most so far from the straight line between") {
    constexpr shape size{1, 1001};
    constexpr double full = 1000;
    support::frame<size> line;
    for (std::size_t i = 0; i < size.size(); ++i)
        line.data()[i] = static_cast<float>(i);
    for (const double error : {0.03, 0.2, -0.05, -0.5, 0.8}) {
        CAPTURE(error);
        const auto bent = support::after<size>(linearity{error, full}, line);
        double greatest = 0;
        for (std::size_t i = 0; i < size.size(); ++i) {
            const double distance =
                static_cast<double>(bent.data()[i]) / full - static_cast<double>(i) / full;
            greatest = std::abs(distance) > std::abs(greatest) ? distance : greatest;
            if (i > 0)
                CHECK(bent.data()[i] > bent.data()[i - 1]);
        }
        // The greatest is met to a thousandth of full scale; the curve is flat there.
        CHECK(greatest == doctest::Approx(error).epsilon(1e-3));
        CHECK(bent.data()[0] == 0);
        CHECK(static_cast<double>(bent.data()[1000]) == doctest::Approx(full).epsilon(1e-6));
    }
    CHECK(support::after<shape{1, 1}>(linearity{0.1, full}, support::filled<shape{1, 1}>(5e3f)).data()[0] ==
          doctest::Approx(5e3).epsilon(1e-6));
}
TEST_CASE("linearity: every tactel follows the curve, and none beyond full scale") {
    constexpr shape one{1, 1};
    const auto bent = [&](double error, float pressure) {
        return static_cast<double>(
            support::after<one>(linearity{error, 1000}, support::filled<one>(pressure)).data()[0]);
    };
    // The curve (1 + b) x / (1 + b x) with b = ((1 + e) / (1 - e))^2 - 1, at e = 1/3: b = 3; half gives 4/5.
    CHECK(bent(1.0 / 3, 500) == doctest::Approx(800).epsilon(1e-6));
    CHECK(bent(1.0 / 3, 1500) == doctest::Approx(1500).epsilon(1e-6));
    // Nine tenths are the most.
    CHECK(bent(0.95, 500) == bent(0.9, 500));
    CHECK(bent(-0.95, 500) == bent(-0.9, 500));
    CHECK(bent(0.9, 500) != bent(0.89, 500));
}
TEST_CASE("linearity: zero error changes no bit, and finite readings never give NaN") {
    constexpr shape size{5, 7};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    support::check_changes_no_bit<size>(linearity{0, 34e3});
    support::check_changes_no_bit<size>(linearity{nan, 34e3});
    support::check_changes_no_bit<size>(linearity{0.03, 0});
    for (const double error : {0.03, -0.03, 100.0, -100.0})
        for (const double full_scale : {34e3, 1e-300, 1e300})
            support::check_no_nan<size>(linearity{error, full_scale});
}
