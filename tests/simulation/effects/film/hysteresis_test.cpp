#include <tactnet/simulation/effects/film/hysteresis.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <vector>

using namespace tactnet;
using simulation::hysteresis;

namespace {

constexpr shape one{1, 1};

struct film {
    hysteresis::bound<one> bound;

    explicit film(const hysteresis& effect) : bound(effect, {}) {}
    double operator()(double pressure) {
        auto value = support::filled<one>(static_cast<float>(pressure));
        bound.apply(value.view(), {});
        return static_cast<double>(value.data()[0]);
    }
};

/// Readings at 0 … full … 0 in a hundred steps each way.
std::vector<double> cycle(film& sensor, double full) {
    std::vector<double> readings;
    for (int i = 0; i <= 200; ++i)
        readings.push_back(sensor(full * (i <= 100 ? i : 200 - i) / 100));
    return readings;
}

} // namespace

TEST_CASE("hysteresis: the loop of a full cycle is as wide as its parameters say") {
    film sensor{hysteresis{}};
    const auto readings = cycle(sensor, 34e3);
    CHECK(readings[150] - readings[50] == doctest::Approx(0.045 * 34e3).epsilon(1e-5));
    // Σ weight · threshold = 765 Pa too little on the way up, too much on the way down.
    CHECK(readings[50] == doctest::Approx(17e3 - 765).epsilon(1e-6));
    CHECK(readings[150] == doctest::Approx(17e3 + 765).epsilon(1e-6));
    for (std::size_t i = 1; i < 100; ++i)
        CHECK(readings[200 - i] >= readings[i]);
    CHECK(readings[0] == 0);
    CHECK(readings[200] == doctest::Approx(765).epsilon(1e-6)); // what remains
}
TEST_CASE("hysteresis: loops close, small ones lie within, and a greater touch wipes them out") {
    film sensor{hysteresis{}};
    cycle(sensor, 34e3);
    const auto second = cycle(sensor, 34e3);
    const auto third = cycle(sensor, 34e3);
    CHECK(second == third);
    // A small loop on the way up does not change what comes after it.
    film other{hysteresis{}};
    for (const double pressure : {5e3, 10e3, 8e3, 10e3})
        other(pressure);
    film straight{hysteresis{}};
    CHECK(other(20e3) == straight(20e3));
}
TEST_CASE("hysteresis: rest is as new, and every tactel remembers for itself") {
    film sensor{hysteresis{}};
    const auto first = cycle(sensor, 20e3);
    CHECK(cycle(sensor, 20e3) != first);
    sensor.bound.reset();
    CHECK(cycle(sensor, 20e3) == first);

    constexpr shape two{1, 2};
    hysteresis::bound<two> bound({}, {});
    support::frame<two> values;
    values.data()[0] = 30e3f, values.data()[1] = 0;
    bound.apply(values.view(), {});
    values.data()[0] = values.data()[1] = 10e3f;
    bound.apply(values.view(), {});
    CHECK(values.data()[0] > 10e3f);
    CHECK(values.data()[1] < 10e3f);
}
TEST_CASE("hysteresis: zero weights change no bit, finite readings never give NaN, and a NaN is forgotten") {
    constexpr shape size{5, 7};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    support::check_changes_no_bit<size>(hysteresis{{{{1e3, 0}, {2e3, -1}, {3e3, nan}, {4e3, 0}}}});
    support::check_no_nan<size>(hysteresis{});
    support::check_no_nan<size>(hysteresis{{{{nan, 0.1}, {-5, 0.2}, {1e300, 0.3}, {0, 9}}}});
    film broken{hysteresis{}}, whole{hysteresis{}};
    broken(10e3), whole(10e3);
    CHECK(std::isnan(broken(nan)));
    CHECK(broken(12e3) == whole(12e3));
}
