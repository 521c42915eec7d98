#include <tactnet/decision/contact_detector.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>

using namespace tactnet;

namespace {

constexpr shape array{28, 50};
using frame = std::array<std::uint8_t, array.size()>;

/// `area` tactels of one count.
frame pressed(std::size_t area, std::uint8_t count) {
    frame counts{};
    for (std::size_t i = 0; i < area; ++i)
        counts[700 + i] = count;
    return counts;
}

} // namespace

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
