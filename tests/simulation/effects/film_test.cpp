#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/film/time.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <span>
#include <support/same_bits.hpp>
#include <vector>

namespace {

using namespace tactnet;
using simulation::creep;
using simulation::drift;
using simulation::film_texture;
using simulation::gain_map;
using simulation::hysteresis;
using simulation::linearity;
using simulation::temperature;

constexpr shape one{1, 1};

double reading(const creep& effect, double seconds) {
    return static_cast<double>(
        support::after<one>(effect, support::filled<one>(1000), {.seconds = seconds}).data()[0]);
}

TEST_CASE("creep: the same share with every decade of time") {
    for (const double time : {0.1, 1.0, 60.0}) {
        const creep effect{.rate = 0.05, .time = time};
        CHECK(reading(effect, 0) == 1000);
        CHECK(reading(effect, 9 * time) == doctest::Approx(1050).epsilon(1e-6));
        CHECK(reading(effect, 99 * time) == doctest::Approx(1100).epsilon(1e-6));
        CHECK(reading(effect, 999 * time) == doctest::Approx(1150).epsilon(1e-6));
    }
}

TEST_CASE("creep: readings never fall below zero, and times before the touch change nothing") {
    CHECK(reading({.rate = -9}, 1e6) == 0);
    CHECK(reading({}, -5) == 1000);
    CHECK(reading({}, std::numeric_limits<double>::quiet_NaN()) == 1000);
}

double rate_of(std::uint64_t sensor, double deviation) {
    return drift::bound<one>(drift{deviation}, {.unit = {sensor}}).rate();
}

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

TEST_CASE("linearity: right at both ends, and at most so far from the straight line between") {
    constexpr shape ramp{1, 1001};
    constexpr double full = 1000;
    support::frame<ramp> line;
    for (std::size_t i = 0; i < ramp.size(); ++i)
        line.data()[i] = static_cast<float>(i);
    for (const double error : {0.03, 0.2, -0.05, -0.5, 0.8}) {
        CAPTURE(error);
        const auto bent = support::after<ramp>(linearity{error, full}, line);
        double greatest = 0;
        for (std::size_t i = 0; i < ramp.size(); ++i) {
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
    CHECK(support::after<one>(linearity{0.1, full}, support::filled<one>(5e3f)).data()[0] ==
          doctest::Approx(5e3).epsilon(1e-6));
}

TEST_CASE("linearity: every tactel follows the curve, and none beyond full scale") {
    const auto bent = [](double error, float pressure) {
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

struct hysteretic_film {
    hysteresis::bound<one> bound;

    explicit hysteretic_film(const hysteresis& effect) : bound(effect, {}) {}
    double operator()(double pressure) {
        auto value = support::filled<one>(static_cast<float>(pressure));
        bound.apply(value.view(), {});
        return static_cast<double>(value.data()[0]);
    }
};

/// Readings at 0 … full … 0 in a hundred steps each way.
std::vector<double> cycle(hysteretic_film& sensor, double full) {
    std::vector<double> readings;
    for (int i = 0; i <= 200; ++i)
        readings.push_back(sensor(full * (i <= 100 ? i : 200 - i) / 100));
    return readings;
}

TEST_CASE("hysteresis: the loop of a full cycle is as wide as its parameters say") {
    hysteretic_film sensor{hysteresis{}};
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
    hysteretic_film sensor{hysteresis{}};
    cycle(sensor, 34e3);
    const auto second = cycle(sensor, 34e3);
    const auto third = cycle(sensor, 34e3);
    CHECK(second == third);
    // A small loop on the way up does not change what comes after it.
    hysteretic_film other{hysteresis{}};
    for (const double pressure : {5e3, 10e3, 8e3, 10e3})
        other(pressure);
    hysteretic_film straight{hysteresis{}};
    CHECK(other(20e3) == straight(20e3));
}

TEST_CASE("hysteresis: rest is as new, and every tactel remembers for itself") {
    hysteretic_film sensor{hysteresis{}};
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

TEST_CASE("hysteresis: a NaN is forgotten") {
    hysteretic_film broken{hysteresis{}}, whole{hysteresis{}};
    broken(10e3), whole(10e3);
    CHECK(std::isnan(broken(std::numeric_limits<double>::quiet_NaN())));
    CHECK(broken(12e3) == whole(12e3));
}

constexpr shape size{28, 50};

support::frame<size> gains_of(std::uint64_t sensor, double deviation = 0.3) {
    return support::after<size>(gain_map{deviation}, support::filled<size>(1), {}, {.unit = {sensor}});
}

TEST_CASE("gain_map: mean one, the given deviation, skewed as the paper's sensor") {
    constexpr std::uint64_t sensors = 100;
    constexpr double n = size.size() * sensors;
    std::vector<double> gains;
    double sum = 0, squares = 0, neighbours = 0;
    for (std::uint64_t sensor = 0; sensor < sensors; ++sensor) {
        const auto drawn = gains_of(sensor);
        for (std::size_t i = 0; i < size.size(); ++i) {
            const double gain = static_cast<double>(drawn.data()[i]);
            gains.push_back(gain);
            sum += gain, squares += (gain - 1) * (gain - 1);
            neighbours += i > 0 ? (gain - 1) * (static_cast<double>(drawn.data()[i - 1]) - 1) : 0;
        }
    }
    CHECK(std::abs(sum / n - 1) < 5 * 0.3 / std::sqrt(n));
    // A log-normal number of this deviation has the kurtosis 4.64, so that its variance scatters by √(3.64 /
    // n).
    CHECK(std::abs(squares / n / 0.09 - 1) < 5 * std::sqrt(3.64 / n));
    CHECK(std::abs(neighbours / n) < 5 * 0.09 / std::sqrt(n));
    // Measured on the paper's images; a log-normal distribution is that within a tenth.
    std::sort(gains.begin(), gains.end());
    const double measured[][2]{{0.01, -0.59}, {0.05, -0.44}, {0.25, -0.23}, {0.5, -0.07},
                               {0.75, 0.13},  {0.95, 0.47},  {0.99, 0.81}};
    for (const auto& [share, gain] : measured)
        CHECK(std::abs(gains[static_cast<std::size_t>(share * n)] - 1 - gain) < 0.1);
}

TEST_CASE("gain_map: multiplies every tactel by its gain, and nothing past the last") {
    const gain_map::bound<size> bound({}, {.unit = {1}});
    std::vector<float> values(size.size() + 1, 2.0F);
    bound.apply(tensor_view<float, size>(std::span<float, size.size()>(values.data(), size.size())), {});
    for (std::size_t i = 0; i < size.size(); ++i)
        CHECK(values[i] == 2 * bound.gains().data()[i]);
    CHECK(values.back() == 2.0F);
    CHECK(bound.gains().data()[0] != 1.0F);
}

TEST_CASE("gain_map: stays with the sensor, frame after frame") {
    CHECK(support::same_bits(gains_of(1), gains_of(1)));
    CHECK_FALSE(support::same_bits(gains_of(1), gains_of(2)));
    gain_map::bound<size> bound({}, {.unit = {1}});
    for (std::uint32_t frame = 0; frame < 2; ++frame) {
        auto values = support::filled<size>(2);
        bound.apply(values.view(), {.seed = frame, .frame = frame, .seconds = 9});
        for (std::size_t i = 0; i < size.size(); ++i)
            CHECK(values.data()[i] == 2 * gains_of(1).data()[i]);
    }
}

using map = tensor<float, size>;

map textured(const film_texture& effect, float pressure, std::uint64_t unit, std::uint32_t frame) {
    map values;
    std::ranges::fill(values, pressure);
    film_texture::bound<size>(effect, {.unit = {unit}}).apply(values.view(), {.frame = frame});
    return values;
}

double deviation(const map& values, double middle) {
    double sum = 0;
    for (const float value : values)
        sum += std::pow(static_cast<double>(value) - middle, 2);
    return std::sqrt(sum / static_cast<double>(map::size()));
}

// Of 1400 tactels the measured deviation itself varies by 1 / √2800 = 1.9 %; five of these.
constexpr double tolerance = 5 * 0.019;

TEST_CASE("texture: the deviation grows with the square root of the pressure") {
    for (const float pressure : {2e3f, 8e3f, 32e3f}) {
        CAPTURE(pressure);
        const auto p = static_cast<double>(pressure);
        const film_texture effect;
        CHECK(deviation(textured({effect.fixed, 0}, pressure, 1, 0), p) ==
              doctest::Approx(effect.fixed * std::sqrt(p)).epsilon(tolerance));
        CHECK(deviation(textured({0, effect.varying}, pressure, 1, 0), p) ==
              doctest::Approx(effect.varying * std::sqrt(p)).epsilon(tolerance));
    }
}

TEST_CASE("texture: one part stays with the sensor, the other changes from frame to frame") {
    CHECK(std::ranges::equal(textured({20, 0}, 1e4f, 1, 0), textured({20, 0}, 1e4f, 1, 9)));
    CHECK(!std::ranges::equal(textured({20, 0}, 1e4f, 1, 0), textured({20, 0}, 1e4f, 2, 0)));
    CHECK(!std::ranges::equal(textured({0, 20}, 1e4f, 1, 0), textured({0, 20}, 1e4f, 1, 1)));
}

TEST_CASE("texture: none changes no bit, where nothing presses nothing is felt, and no reading is "
          "below zero") {
    map values;
    for (std::size_t i = 0; i < map::size(); ++i)
        values.data()[i] = static_cast<float>(i * i) * 0.0371f;
    map same = values;
    film_texture::bound<size>(film_texture{0, 0}, {}).apply(same.view(), {});
    CHECK(std::ranges::equal(same, values));
    CHECK(std::ranges::all_of(textured({}, 0, 1, 0), [](float value) { return value == 0; }));
    CHECK(std::ranges::all_of(textured({200, 200}, 100, 1, 0), [](float value) { return value >= 0; }));
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    CHECK(std::ranges::all_of(textured({}, none, 1, 0), [](float value) { return std::isnan(value); }));
}

} // namespace
