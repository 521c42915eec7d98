#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/sensor_health.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape array{28, 50};
using frame = std::array<std::uint8_t, array.size()>;

/// `area` tactels of one count.
frame pressed(std::size_t area, std::uint8_t count) {
    frame counts{};
    for (std::size_t i = 0; i < area; ++i)
        counts[700 + i] = count;
    return counts;
}

TEST_CASE("contact_detector: begins at begin_area and ends at end_area, after their frames in a row") {
    contact_detector<array> detector;
    const auto touching = [&](const frame& next) { return detector.update(next).touching; };
    CHECK_FALSE(touching(pressed(12, 8)));
    CHECK_FALSE(touching(pressed(11, 255))); // starts again
    CHECK_FALSE(touching(pressed(12, 7)));   // not pressed
    CHECK_FALSE(touching(pressed(12, 8)));
    CHECK(touching(pressed(12, 8)));
    CHECK(detector.now().began);
    CHECK(detector.now().area == 12);
    CHECK(detector.now().force == 96);
    CHECK(touching(pressed(7, 255)));
    CHECK_FALSE(detector.now().began);
    CHECK(touching(pressed(6, 255)));
    CHECK(touching(pressed(6, 255)));
    CHECK(touching(pressed(7, 255))); // starts again
    CHECK(touching(pressed(0, 0)));
    CHECK(touching(pressed(0, 0)));
    CHECK_FALSE(touching(pressed(6, 255)));
    CHECK(detector.now().ended);
    CHECK_FALSE(touching(pressed(0, 0)));
    CHECK_FALSE(detector.now().ended);
    CHECK(detector.now().frames == 2);
}

TEST_CASE("contact_detector: area and force of a whole array of the largest count") {
    contact_detector<array> detector;
    frame all{};
    all.fill(255);
    const contact_state& found = detector.update(all);
    CHECK(found.area == array.size());
    CHECK(found.force == 255 * array.size());
}

TEST_CASE("contact_detector: learn raises the least count of a pressed tactel above the noise of air") {
    contact_detector<array> detector;
    CHECK(detector.pressed() == 8);
    detector.learn(pressed(3, 4));
    CHECK(detector.pressed() == 8);
    detector.learn(pressed(3, 9));
    detector.learn(pressed(3, 2));
    CHECK(detector.pressed() == 12);
    CHECK(detector.update(pressed(100, 11)).area == 0);
    CHECK(detector.update(pressed(100, 12)).area == 100);
    detector.learn(pressed(3, 255));
    CHECK(detector.pressed() == 255);
}

TEST_CASE("contact_detector: settings of 0 mean their least value") {
    contact_detector<shape{7, 13}> detector(
        {.pressed = 0, .begin_area = 1, .end_area = 0, .begin_frames = 0, .end_frames = 0});
    CHECK(detector.pressed() == 1);
    std::array<std::uint8_t, 91> counts{};
    CHECK_FALSE(detector.update(counts).touching);
    counts[90] = 1;
    CHECK(detector.update(counts).touching);
    CHECK(detector.now().area == 1);
    counts[90] = 0;
    CHECK_FALSE(detector.update(counts).touching);
}

TEST_CASE("contact_detector: the tactels that begin a contact follow from the array, unless they are set") {
    CHECK(contact_settings::begin_area_of({64, 64}) == 12);
    CHECK(contact_settings::begin_area_of({28, 50}) == 12);
    CHECK(contact_settings::begin_area_of({20, 35}) == 6);
    CHECK(contact_settings::begin_area_of({7, 13}) == 3);
    CHECK(contact_settings::begin_area_of({4, 4}) == 1);
    CHECK(contact_settings::begin_area_of({1, 1}) == 1);
    std::array<std::uint8_t, 91> three{50, 50, 50};
    contact_detector<shape{7, 13}> by_default, set({.begin_area = 4});
    for (int i = 0; i < 2; ++i) {
        CHECK(by_default.update(three).touching == (i == 1));
        CHECK_FALSE(set.update(three).touching);
    }
    three[1] = 0; // 2: neither begins nor ends it
    for (int i = 0; i < 3; ++i)
        CHECK(by_default.update(three).touching);
    CHECK_FALSE(by_default.now().firm);
}

TEST_CASE("contact_detector: frames of air after a release are not firm") {
    contact_detector<array> detector;
    std::vector<bool> touching, firm;
    for (const std::size_t area : {100, 100, 100, 12, 11, 100, 0, 0, 0}) {
        const contact_state& now = detector.update(pressed(area, 50));
        touching.push_back(now.touching), firm.push_back(now.firm);
    }
    CHECK(touching == std::vector<bool>{false, true, true, true, true, true, true, true, false});
    CHECK(firm == std::vector<bool>{false, true, true, true, false, true, false, false, false});
}

TEST_CASE("contact_detector: the noise of air raises the least count, also when its largest is not seen") {
    contact_detector<shape{4, 4}> detector;
    std::array<std::uint8_t, 16> air{};
    for (std::size_t i = 0; i < 8; ++i)
        air[i] = 4; // of noise of 4 counts: the others are below the baseline
    detector.learn(air);
    CHECK(detector.pressed() == 20);
}

// A stream of a sensor that drifts, with noise, creep and long contacts; simulated, since no such recording
// is available.

constexpr std::size_t tactels = array.size();

/// At 100 frames per second: Gaussian noise of 1.5 counts; an offset of all tactels between 0 and 20 counts,
/// over an hour; one of each tactel of ±4 counts, over 20 to 80 minutes; contacts whose counts grow by creep
/// of 5 % for each factor of e, and leave 4 % behind, which fade within 5 s.
class drifting_sensor {
public:
    explicit drifting_sensor(std::uint64_t seed) : random_(seed), noise_(65536) {
        std::normal_distribution<float> normal(0, 1.5F);
        for (float& value : noise_)
            value = normal(random_);
        for (std::size_t i = 0; i < tactels; ++i) {
            phase_[i] = static_cast<float>(random_() % 1000) / 1000 * turn;
            period_[i] = static_cast<float>(120'000 + random_() % 360'000);
            const int y = static_cast<int>(i / 50) - 14, x = static_cast<int>(i % 50) - 25;
            touch_[i] = static_cast<float>(std::max(0, 170 - 2 * (y * y + x * x)));
        }
    }

    frame next(bool touched) {
        if (touched != touched_)
            since_ = 0;
        touched_ = touched;
        const auto time = static_cast<float>(frames_++), since = static_cast<float>(since_++);
        if (frames_ % 64 == 1)
            for (std::size_t i = 0; i < tactels; ++i)
                drift_[i] = 10 - 10 * std::cos(turn * time / 360'000) +
                            4 * std::sin(phase_[i] + turn * time / period_[i]);
        const float share = touched ? 1 + 0.05F * std::log1p(since / 100)
                                    : (frames_ > since_ ? 0.04F * std::exp(-since / 500) : 0);
        frame counts{};
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < tactels; ++i, bits >>= 16U) {
            if (i % 4 == 0)
                bits = random_();
            const float count = drift_[i] + noise_[bits & 0xFFFFU] + share * touch_[i];
            counts[i] = static_cast<std::uint8_t>(std::clamp(std::round(count), 0.0F, 255.0F));
        }
        return counts;
    }
    std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_() % bound); }

private:
    static constexpr float turn = 6.2831853F;
    std::mt19937_64 random_;
    std::vector<float> noise_;
    std::array<float, tactels> phase_{}, period_{}, touch_{}, drift_{};
    std::size_t frames_ = 0, since_ = 0;
    bool touched_ = false;
};

struct stage {
    sensor_health<array> health;
    contact_detector<array> detector;

    void learn(drifting_sensor& sensor) {
        for (int i = 0; i < 100; ++i) {
            const auto air = sensor.next(false);
            health.learn(air);
            if (i >= 50)
                detector.learn(health.clean(air));
        }
    }
    bool touching(const frame& raw) {
        const bool found = detector.update(health.clean(raw)).touching;
        if (!found)
            health.follow(raw);
        return found;
    }
};

TEST_CASE("contact_detector: no contact in air, with noise and drift") {
    drifting_sensor sensor(5);
    stage of;
    of.learn(sensor);
    std::size_t contacts = 0;
    for (int i = 0; i < 200'000; ++i)
        contacts += of.touching(sensor.next(false));
    CHECK(contacts == 0);
    CHECK(of.health.faults().empty());
    CHECK(of.health.mean_baseline() > 5); // it has drifted
}

TEST_CASE("contact_detector: contacts of up to 90 s are kept, with creep, and end soon after they are over") {
    drifting_sensor sensor(6);
    stage of;
    of.learn(sensor);
    for (int contact = 0; contact < 8; ++contact) {
        for (std::size_t air = 3000 + sensor.below(10'000); air > 0; --air)
            REQUIRE_FALSE(of.touching(sensor.next(false)));
        const std::size_t length = contact == 0 ? 9000 : 20 + sensor.below(6000);
        for (std::size_t i = 0; i < length; ++i) {
            const bool found = of.touching(sensor.next(true));
            if (i >= 1) // begin_frames
                REQUIRE(found);
        }
        std::size_t late = 0;
        while (of.touching(sensor.next(false)))
            ++late;
        CHECK(late < 200); // 2 s
    }
    CHECK(of.health.faults().empty());
}

} // namespace
