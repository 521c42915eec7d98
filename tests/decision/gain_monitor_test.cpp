#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/sensor_health.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <support/allocations.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape array{28, 50};
constexpr std::size_t tactels = array.size();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
using bytes = std::array<std::uint8_t, tactels>;

bytes touch_at(int row, int column) {
    bytes counts{};
    for (std::size_t i = 0; i < tactels; ++i) {
        const int y = static_cast<int>(i / 50) - row, x = static_cast<int>(i % 50) - column;
        counts[i] = static_cast<std::uint8_t>(std::max(0, 170 - 2 * (y * y + x * x)));
    }
    return counts;
}

/// A sensor whose counts are those of 8 bits on another scale.
template <class Count>
struct device {
    count_scale scale;
    std::array<Count, tactels> of(const bytes& counts) const {
        std::array<Count, tactels> raw;
        for (std::size_t i = 0; i < tactels; ++i) {
            const float value =
                scale.untouched + static_cast<float>(counts[i]) * (scale.full - scale.untouched) / 255;
            raw[i] = static_cast<Count>(std::is_integral_v<Count> ? std::round(value) : value);
        }
        return raw;
    }
};

/// Plays air, touches, a stuck row and drift to both, which must agree.
template <class Count>
void check_same(const device<Count>& of, float bound) {
    sensor_health<array> health;
    contact_detector<array> detector;
    sensor_health<array, float> deep(of.scale);
    contact_detector<array, float> deep_detector;
    std::mt19937 random(3);
    float difference = 0;
    std::size_t contacts = 0, allocated = 0;
    for (int f = 0; f < 400; ++f) {
        bytes counts = f % 100 < 50 ? bytes{} : touch_at(10 + f / 50, 20);
        for (std::size_t i = 0; i < tactels; ++i)
            counts[i] = static_cast<std::uint8_t>(
                f >= 200 && i / 50 == 3 ? 255 : counts[i] + i % 7 + random() % 2 + (f > 300 ? 5 : 0));
        const auto raw = of.of(counts);
        const std::size_t before = support::allocations();
        if (f < 50) {
            health.learn(counts), deep.learn(raw);
            detector.learn(health.clean(counts)), deep_detector.learn(deep.clean(raw));
        } else {
            const auto clean = health.clean(counts);
            const auto deep_clean = deep.clean(raw);
            for (std::size_t i = 0; i < tactels; ++i)
                difference = std::max(difference, std::abs(deep_clean[i] - static_cast<float>(clean[i])));
            const contact_state &now = detector.update(clean), &deep_now = deep_detector.update(deep_clean);
            CHECK(now.touching == deep_now.touching);
            CHECK(now.firm == deep_now.firm);
            if (now.firm) {
                CHECK(deep_now.force == doctest::Approx(now.force).epsilon(0.05));
                CHECK(deep_now.area == doctest::Approx(now.area).epsilon(0.05));
            }
            contacts += now.began;
            if (!now.touching) {
                health.follow(counts);
                deep.follow(raw);
            }
        }
        allocated += support::allocations() - before;
    }
    CHECK(contacts == 4);
    CHECK(difference <= bound);
    CHECK(deep.faults().size() == 50);
    CHECK(health.faults().size() == 50);
    CHECK(deep.mean_baseline() == doctest::Approx(health.mean_baseline()).epsilon(0.1));
    CHECK(allocated == 0);
}

} // namespace

TEST_CASE("count_scale: counts of any depth, inverted ones too, on the scale of 8 bits") {
    CHECK(count_scale{.full = 4095}.of(4095) == 255);
    CHECK(count_scale{.untouched = 2135, .full = 0}.of(2135) == 0);
    CHECK(count_scale{.untouched = 2135, .full = 0}.of(0) == 255);
    CHECK(count_scale{.untouched = 2135, .full = 0}.of(3000) == 0);
    CHECK(count_scale{.full = 1}.of(2) == 510);
    CHECK(std::isnan(count_scale{}.of(not_a_number)));
    CHECK(std::isnan(count_scale{.broken = -1}.of(-1)));
    CHECK(count_scale{.untouched = 3, .full = 3}.of(7) == 0);
}

TEST_CASE("sensor_health: counts of any depth are cleaned, felt and judged as those of 8 bits") {
    check_same(device<std::uint8_t>{}, 1.6F); // baselines have fractions
    check_same(device<std::uint16_t>{{.full = 4095}}, 1.6F);
    check_same(device<std::uint16_t>{{.full = 65535}}, 1.6F);
    check_same(device<std::uint16_t>{{.untouched = 2135, .full = 0}}, 1.7F);
    check_same(device<std::uint16_t>{{.untouched = 3072, .full = 96}}, 1.7F);
    check_same(device<float>{{.full = 1}}, 1.6F);
}

TEST_CASE("sensor_health: fractions of counts are kept") {
    sensor_health<array, float> health({.full = 4095});
    std::array<std::uint16_t, tactels> raw{};
    raw[700] = 1001; // 62.33 counts of 8 bits
    CHECK(health.clean(raw)[700] == doctest::Approx(1001.0 / 4095 * 255).epsilon(1.0 / 16384));
}

TEST_CASE("sensor_health: tactels that the sensor marks as broken are reported, replaced, and used again") {
    for (const float mark : {not_a_number, std::numeric_limits<float>::infinity(), -1.0F}) {
        sensor_health<array, float> health({.full = 1, .broken = -1});
        const bytes touch = touch_at(14, 25);
        auto raw = device<float>{{.full = 1}}.of(touch);
        const auto good = raw;
        raw[14 * 50 + 25] = mark;
        for (int i = 0; i < 3; ++i) {
            health.learn(std::array<float, tactels>{});
            const auto clean = health.clean(raw); // at once
            REQUIRE(health.faults().size() == 1);
            CHECK(health.faults()[0].kind == tactel_fault_kind::broken);
            CHECK(name_of(health.faults()[0].kind) == "broken");
            CHECK(health.faults()[0].row == 14);
            CHECK(health.faults()[0].column == 25);
            CHECK(std::abs(clean[14 * 50 + 25] - 167) < 1); // the mean beside it
        }
        const auto saved = health.save();
        sensor_health<array, float> next({.full = 1, .broken = -1});
        REQUIRE(next.restore(saved) == restore_status::ok);
        CHECK(next.faults()[0].kind == tactel_fault_kind::broken);
        for (int i = 0; i < 199; ++i)
            (void)health.clean(good);
        (void)health.clean(raw); // starts again
        for (int i = 0; i < 199; ++i)
            (void)health.clean(good);
        CHECK(health.faults().size() == 1);
        CHECK(std::abs(health.clean(good)[14 * 50 + 25] - 167) < 1);
        CHECK(health.faults().empty());
        CHECK(health.clean(good)[14 * 50 + 25] == doctest::Approx(170).epsilon(0.001));
    }
}

TEST_CASE(
    "sensor_health: a broken tactel among frames of air is learnt around, and its state is not of bytes") {
    sensor_health<array, float> health({.full = 255});
    contact_detector<array, float> detector;
    std::array<float, tactels> air{};
    air.fill(12.5F);
    air[5] = not_a_number;
    for (int i = 0; i < 50; ++i) {
        health.learn(air);
        detector.learn(health.clean(air));
    }
    CHECK(detector.pressed() == 8);
    for (int i = 0; i < 1000; ++i) {
        CHECK_FALSE(detector.update(health.clean(air)).touching);
        health.follow(air);
    }
    CHECK(health.faults().size() == 1);
    CHECK(health.mean_baseline() == doctest::Approx(12.5).epsilon(0.01));
    sensor_health<array> of_bytes;
    CHECK(of_bytes.restore(health.save()) != restore_status::ok);
    health.forget();
    CHECK(health.faults().empty());
    CHECK(health.clean(air)[0] == doctest::Approx(12.5).epsilon(0.001)); // the scale stays
}
