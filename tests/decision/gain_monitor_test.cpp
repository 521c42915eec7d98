#include <tactnet/decision/gain_monitor.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

using namespace tactnet;

TEST_CASE("force_statistics: mean and deviation of the logarithms, without empty images") {
    const std::vector<std::uint8_t> images{1, 1,  0, 0,  4,
                                           4, 10, 0, 255}; // 2, none, 8, 10; one pixel too many
    const force_statistics found = force_statistics::of(images, 2, 1);
    const double a = std::log(2.0), b = std::log(8.0), c = std::log(10.0), mean = (a + b + c) / 3;
    CHECK(found.mean == doctest::Approx(mean));
    CHECK(found.deviation ==
          doctest::Approx(
              std::sqrt(((a - mean) * (a - mean) + (b - mean) * (b - mean) + (c - mean) * (c - mean)) / 2)));
    CHECK(force_statistics::of(std::vector<std::uint8_t>{2, 8}, 1, 1).mean == doctest::Approx(std::log(4.0)));
    // Counts below `pressed` are no part of a force: 8, 10 and none here.
    CHECK(force_statistics::of(images, 2, 4).mean == doctest::Approx((b + c) / 2));
    CHECK(force_statistics::of({}, 2, 1).mean == 0);
    CHECK(force_statistics::of(images, 0, 1).deviation == 0);
    CHECK(force_statistics::of(std::vector<std::uint8_t>{3, 3}, 2, 1).deviation == 0);
}

TEST_CASE("gain_monitor: finds a gain within its uncertainty, and reports drift only where there is one") {
    const force_statistics trained{9, 0.6};
    std::mt19937 random(7);
    std::normal_distribution<double> forces(trained.mean, trained.deviation);
    for (const double gain : {0.5, 0.7, 1.0, 1.6}) {
        std::size_t drifted = 0, far = 0;
        for (int trial = 0; trial < 200; ++trial) {
            gain_monitor monitor(trained, 50, 10); // without much shrinkage
            CHECK(monitor.gain() == 1);
            CHECK_FALSE(monitor.drifted());
            for (int touch = 0; touch < 300; ++touch)
                monitor.add_touch(gain * std::exp(forces(random)));
            drifted += monitor.drifted();
            // The mean of an exponential memory of 50 touches scatters as one of 99.
            far += std::abs(std::log(monitor.gain() / gain)) > 4 * trained.deviation / std::sqrt(99.0);
        }
        CAPTURE(gain);
        CHECK(far <= 1);
        if (gain == 1)
            CHECK(drifted <= 4); // of 200, beyond three deviations
        else
            CHECK(drifted >= 195); // 0.7 is six deviations from 1
    }
}

TEST_CASE("gain_monitor: few touches move the estimate little") {
    gain_monitor monitor({9, 0.6}, 50, 0.3);
    monitor.add_touch(std::exp(9.0) * 0.5);
    CHECK(monitor.gain() == doctest::Approx(std::exp(std::log(0.5) / 5))); // 1 / (1 + (0.6 / 0.3)²)
}

TEST_CASE("gain_monitor: older touches weigh less, by the memory") {
    gain_monitor monitor({0, 0}, 4); // forces that do not scatter: no shrinkage
    monitor.add_touch(0.5);
    monitor.add_touch(0.5);
    monitor.add_touch(2);
    const double first = 0.75 * 0.75, second = 0.75;
    CHECK(std::log(monitor.gain()) ==
          doctest::Approx(std::log(2.0) * (1 - first - second) / (1 + first + second)));
}

TEST_CASE("gain_monitor: no force, NaN and infinity are no touches") {
    gain_monitor monitor({9, 0.6});
    for (const double force :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        monitor.add_touch(force);
    CHECK(monitor.gain() == 1);
}
