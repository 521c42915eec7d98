#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/circuit/resistive_network.hpp>
#include <tactnet/simulation/effects/circuit/wiring.hpp>
#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/film/time.hpp>
#include <tactnet/simulation/effects/storage.hpp>
#include <tactnet/simulation/objects/object.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <simulation/effect_frames.hpp>
#include <support/same_bits.hpp>

namespace {

using namespace tactnet::simulation;
using tactnet::philox;

// Images made with one version of the library are those of the next: these numbers stay.
static_assert(tactnet::random_purposes::sensor.number() == 7);
static_assert(tactnet::random_purposes::frame.number() == 8);
static_assert(tactnet::random_purposes::touch.number() == 9);
static_assert(gain_map::purpose.number() == 0);
static_assert(dead_tactels::purpose.number() == 1);
static_assert(noise::purpose.number() == 2);
static_assert(drift::purpose.number() == 3);
static_assert(film_texture::purpose.number() == 7);

/// An effect as a user writes one, with random numbers of its own.
struct slip {
    static constexpr auto purpose = effect_purpose::named("my_gripper/slip");
};

TEST_CASE("sensor_unit: random numbers are those of its number and the use") {
    constexpr sensor_unit unit{0x0123'4567'89AB'CDEF};
    auto random = unit.random(noise::purpose);
    for (const std::uint32_t word : philox({0, 7, 0, 2}, {0x89AB'CDEF, 0x0123'4567}))
        CHECK(random.bits() == word);
}

TEST_CASE("moment: random numbers are those of its seed, its frame and the use") {
    constexpr moment now{.seed = 0x0123'4567'89AB'CDEF, .frame = 5};
    auto random = now.random(film_texture::purpose);
    for (const std::uint32_t word : philox({0, 8, 5, 7}, {0x89AB'CDEF, 0x0123'4567}))
        CHECK(random.bits() == word);
}

TEST_CASE("effect_purpose: every effect has numbers of its own, a user's too") {
    const std::array purposes{gain_map::purpose, dead_tactels::purpose, noise::purpose,
                              drift::purpose,    film_texture::purpose, slip::purpose};
    std::set<std::uint32_t> numbers, of_sensors, of_frames;
    for (const effect_purpose purpose : purposes) {
        numbers.insert(purpose.number());
        of_sensors.insert(sensor_unit{}.random(purpose).bits());
        of_frames.insert(moment{}.random(purpose).bits());
    }
    CHECK(numbers.size() == purposes.size());
    CHECK(of_sensors.size() == purposes.size());
    CHECK(of_frames.size() == purposes.size());
    CHECK(slip::purpose.number() >= 0x8000'0000);
}

constexpr tactnet::shape size{9, 11};
constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();

template <class Effect>
void check_changes_no_bit(const Effect& effect) {
    const moment now{.seconds = 100, .celsius = 60};
    const auto unchanged = [&](const support::frame<size>& values) {
        return support::same_bits(support::after<size>(effect, values, now), values);
    };
    for (std::uint32_t sample = 0; sample < 10; ++sample)
        CHECK(unchanged(support::pressed<size>(sample)));
    for (const float value : {-0.0f, -5.0f, 1e-40f, 1e30f})
        CHECK(unchanged(support::filled<size>(value)));
}

TEST_CASE("effect: one without strength, or with an impossible one, changes no bit, whatever reaches it") {
    std::size_t rows = 0;
    const auto check = [&](const auto&... effects) {
        const std::size_t row = ++rows; // CAPTURE evaluates what it is given only when a check fails
        CAPTURE(row);
        (check_changes_no_bit(effects), ...);
    };
    check(crosstalk{0, 0}, crosstalk{-1, nan});
    check(dead_tactels{.single = 0}, dead_tactels{.single = -1, .row = nan});
    check(noise{.additive = 0, .relative = 0}, noise{.additive = -1, .relative = nan});
    check(resistive_network{.grounding = infinity}, resistive_network{.sensitivity = 0},
          resistive_network{.sensitivity = -1});
    check(saturation{.limit = infinity});
    check(threshold{0}, threshold{-1}, threshold{nan});
    check(creep{.rate = 0}, creep{.time = 0}, creep{.time = -1});
    check(drift{0}, drift{-1}, drift{nan});
    check(gain_map{0}, gain_map{-1}, gain_map{nan});
    check(hysteresis{{{{1e3, 0}, {2e3, -1}, {3e3, nan}, {4e3, 0}}}});
    check(linearity{0, 34e3}, linearity{nan, 34e3}, linearity{0.03, 0});
    check(temperature{.sensitivity = 0}, temperature{.calibrated = 60}); // that of the trial
    check(jpeg_storage{0}, jpeg_storage{-3});
    check(resolution<size.rows, size.columns>{});
}

/// NaN is not hidden.
template <class Effect>
void check_no_nan(const Effect& effect) {
    constexpr float most = std::numeric_limits<float>::max();
    const moment now{.seconds = 1e9, .celsius = -300};
    for (const float value : {0.0f, -0.0f, 1e-45f, 1.0f, -1.0f, 34e3f, 1e20f, -1e20f, most, -most}) {
        CAPTURE(value);
        support::frame<size> mixed = support::pressed<size>();
        mixed.data()[size.size() / 2] = value;
        for (const support::frame<size>& values : {support::filled<size>(value), mixed}) {
            std::size_t nans = 0;
            for (const float result : support::after<size>(effect, values, now))
                nans += std::isnan(result);
            CHECK(nans == 0);
        }
    }
    support::frame<size> broken = support::pressed<size>();
    broken.data()[size.size() / 2] = std::numeric_limits<float>::quiet_NaN();
    CHECK(std::isnan(support::after<size>(effect, broken).data()[size.size() / 2]));
}

TEST_CASE("effect: finite readings, however large, small or below zero, never give NaN") {
    std::size_t rows = 0;
    const auto check = [&](const auto&... effects) {
        const std::size_t row = ++rows;
        CAPTURE(row);
        (check_no_nan(effects), ...);
    };
    check(crosstalk{}, crosstalk{1e300, 0}, crosstalk{0, 1e300});
    check(dead_tactels{});
    check(noise{}, noise{.additive = 0, .relative = 1e300}, noise{.additive = 1e300, .relative = 0},
          noise{.additive = infinity, .relative = 1e-30});
    for (const double grounding : {-1.0, 0.0, 1e-30, 1e-2, 1e30})
        check(resistive_network{.grounding = grounding});
    check(saturation{});
    check(threshold{});
    for (const double rate : {0.05, -9.0, 1e300})
        check(creep{.rate = rate, .time = 1e-300});
    check(drift{}, drift{1e300});
    check(gain_map{}, gain_map{1e300});
    check(hysteresis{}, hysteresis{{{{nan, 0.1}, {-5, 0.2}, {1e300, 0.3}, {0, 9}}}});
    for (const double error : {0.03, -0.03, 100.0, -100.0})
        for (const double full_scale : {34e3, 1e-300, 1e300})
            check(linearity{error, full_scale});
    check(temperature{}, temperature{.sensitivity = -1e300});
}

} // namespace
