#include <tactnet/decision/discriminant.hpp>
#include <tactnet/decision/gain_monitor.hpp>
#include <tactnet/decision/probabilities.hpp>
#include <tactnet/decision/touch_evidence.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <support/allocations.hpp>
#include <vector>

namespace {

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
    gain_monitor monitor({std::log(8.0), 0}, 4); // forces that do not scatter: no shrinkage
    monitor.add_touch(4);
    monitor.add_touch(4);
    monitor.add_touch(16);
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

TEST_CASE("gain_monitor: statistics of nothing, and numbers that no forces have, move nothing") {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                     infinity = std::numeric_limits<double>::infinity();
    const std::array<std::uint8_t, 6> air{}, one{9, 0, 0, 0, 0, 0};
    for (const force_statistics& trained :
         {force_statistics::of(air, 2, 1), force_statistics::of(one, 2, 1), force_statistics{nan, 1},
          force_statistics{9, nan}, force_statistics{9, infinity}, force_statistics{-infinity, 1},
          force_statistics{9, -1}, force_statistics{1e300, 1}}) {
        gain_monitor monitor(trained);
        monitor.add_touch(5000);
        CHECK(monitor.gain() == 1);
        CHECK_FALSE(monitor.drifted());
        CHECK(monitor.uncertainty() == 0.3);
    }
    for (const double memory : {nan, -infinity, 0.0, infinity})
        for (const double deviation : {nan, -infinity, 0.0, infinity})
            for (const force_statistics& trained : {force_statistics{-745, 1}, force_statistics{1, 0}}) {
                gain_monitor monitor(trained, memory, deviation);
                CHECK(std::isfinite(monitor.uncertainty()));
                for (int touch = 0; touch < 100; ++touch)
                    monitor.add_touch(1e308);
                CHECK(std::isfinite(monitor.gain()));
                CHECK(monitor.gain() > 1);
                CHECK(std::isfinite(monitor.uncertainty()));
            }
}

using four_logits = std::array<float, 4>;

double probability_of(const four_logits& sums, std::size_t classes) {
    double all = 0, most = 0;
    for (std::size_t c = 0; c < classes; ++c) {
        all += std::exp(static_cast<double>(sums[c]));
        most = std::max(most, std::exp(static_cast<double>(sums[c])));
    }
    return most / all;
}

TEST_CASE("touch_evidence: frames of a grasp and grasps of an object count by their correlation") {
    const four_logits first{1, 2, 0, 9}, second{3, 1, 0, 9};
    touch_evidence<4> evidence(3);
    CHECK_FALSE(evidence.most_likely().has_value());
    CHECK_FALSE(evidence.decide(0.9).has_value());
    CHECK(evidence.add_frame(first));
    CHECK(evidence.grasps() == 1);
    CHECK(evidence.most_likely()->index == 1);
    CHECK(evidence.most_likely()->probability == doctest::Approx(probability_of(first, 3)));
    CHECK(evidence.add_frame(first)); // says nothing new
    CHECK(evidence.most_likely()->probability == doctest::Approx(probability_of(first, 3)));
    evidence.end_grasp();
    evidence.end_grasp();
    CHECK(evidence.grasps() == 1);
    CHECK(evidence.add_frame(second));
    CHECK(evidence.grasps() == 2);
    CHECK(evidence.most_likely()->index == 0);
    CHECK(evidence.most_likely()->probability ==
          doctest::Approx(probability_of({4 / 1.35f, 3 / 1.35f, 0, 9}, 3)));
    evidence.end_grasp();
    CHECK(evidence.add_frame(second));
    CHECK(evidence.most_likely()->probability ==
          doctest::Approx(probability_of({7 / 1.7f, 4 / 1.7f, 0, 9}, 3)));
    evidence.clear();
    CHECK(evidence.grasps() == 0);
    CHECK_FALSE(evidence.most_likely().has_value());

    for (const double correlation : {-1.0, 0.0, 0.5, 1.0, 7.0}) {
        const auto share = static_cast<float>(1 / (1 + std::clamp(correlation, 0.0, 1.0)));
        const four_logits together{4 * share, 3 * share, 0, 9};
        touch_evidence<4> of_frames(3, {}, {.frames = correlation});
        (void)of_frames.add_frame(first);
        (void)of_frames.add_frame(second);
        CHECK(of_frames.most_likely()->probability == doctest::Approx(probability_of(together, 3)));
        touch_evidence<4> of_grasps(3, {}, {.grasps = correlation});
        (void)of_grasps.add_frame(first);
        of_grasps.end_grasp();
        (void)of_grasps.add_frame(second);
        CHECK(of_grasps.most_likely()->probability == doctest::Approx(probability_of(together, 3)));
    }
}

TEST_CASE("touch_evidence: the temperature scales each frame") {
    touch_evidence<4> evidence(4, {2.0});
    (void)evidence.add_frame(four_logits{1, 2, 0, 4});
    CHECK(evidence.most_likely()->probability == doctest::Approx(probability_of({0.5f, 1, 0, 2}, 4)));
}

TEST_CASE("touch_evidence: a frame that is not finite is not taken") {
    touch_evidence<4> evidence;
    CHECK_FALSE(evidence.add_frame(four_logits{0, 0, std::numeric_limits<float>::quiet_NaN(), 0}));
    CHECK_FALSE(evidence.add_frame(four_logits{0, std::numeric_limits<float>::infinity(), 0, 0}));
    CHECK(evidence.grasps() == 0);
}

TEST_CASE("touch_evidence: where probabilities are calibrated and grasps independent, decisions keep the "
          "promised rate of errors") {
    // Logits are log-likelihoods of a Gaussian observation with four possible means: exact posteriors.
    std::mt19937 random(11);
    std::normal_distribution<double> noise;
    for (const double rate : {0.1, 0.01}) {
        constexpr std::size_t trials = 20'000;
        std::size_t wrong = 0, grasps = 0;
        for (std::size_t trial = 0; trial < trials; ++trial) {
            const std::size_t truth = trial % 4;
            touch_evidence<4> evidence(4, {}, {.grasps = 0});
            while (!evidence.decide(rate)) {
                const double seen = static_cast<double>(truth) + noise(random);
                four_logits found{};
                for (std::size_t c = 0; c < 4; ++c)
                    found[c] = static_cast<float>(-(seen - static_cast<double>(c)) *
                                                  (seen - static_cast<double>(c)) / 2);
                (void)evidence.add_frame(found);
                evidence.end_grasp();
            }
            wrong += evidence.decide(rate)->index != truth;
            grasps += evidence.grasps();
        }
        CAPTURE(rate);
        const double deviation = std::sqrt(rate * (1 - rate) / trials);
        CHECK(static_cast<double>(wrong) / trials <= rate + 3 * deviation);
        CHECK(wrong > 0);
        CHECK(grasps > trials); // one is seldom enough
        CHECK(grasps < 30 * trials);
    }
}

using means_type = class_means<2, 4>;

TEST_CASE("sum_of_exponentials: within its bound of a sum in double, for any number of values") {
    std::mt19937 random(4);
    for (const std::size_t count : {1U, 3U, 22U, 63U, 64U, 65U, 200U})
        for (const double scale : {0.05, 1.0, 20.0}) {
            std::normal_distribution<float> normal(-300, 9);
            std::vector<float> values(count);
            for (float& value : values)
                value = normal(random);
            const detail::value_range<float> range{std::span<const float>(values)};
            CHECK(range.finite);
            double expected = 0;
            for (const float value : values)
                expected +=
                    std::exp((static_cast<double>(value) - static_cast<double>(range.largest)) * scale);
            const double found =
                detail::sum_of_exponentials(std::span<const float>(values), range.largest, scale);
            // An exponent below 2⁷ is rounded to 2⁻¹⁸; its power, and what is left out, are smaller errors.
            CHECK(std::abs(found - expected) <= 0x1p-17 * (expected - 1) + 1e-12);
        }
    CHECK_FALSE(detail::value_range<float>(std::array{1.0F, std::nanf("")}).finite);
    CHECK_FALSE(detail::value_range<float>(std::array{-std::numeric_limits<float>::infinity()}).finite);
}

TEST_CASE("class_means: distances relative to the spread, by hand") {
    means_type means;
    CHECK_FALSE(means.nearest({3, 0}).has_value()); // nothing has been learnt
    // Class 0 spreads by 1, class 1 by 9: 5 on average, which counts as eight touches.
    for (const float x : {-1.0F, 1.0F})
        CHECK(means.learn(0, {x, 0}));
    CHECK(means.nearest({3, 0})->relative_distance == doctest::Approx(9));
    for (const float x : {47.0F, 53.0F})
        CHECK(means.learn(1, {x, 0}));
    CHECK(means.nearest({3, 0})->relative_distance == doctest::Approx(9 / ((2 * 1 + 8 * 5) / 10.0)));
    CHECK(means.nearest({50, 3})->relative_distance == doctest::Approx(9 / ((2 * 9 + 8 * 5) / 10.0)));
}

TEST_CASE("class_means: what is not finite is near no class, and there is no heap") {
    means_type means;
    CHECK(means.learn(0, {0, 0}));
    const std::size_t before = support::allocations();
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()})
        CHECK_FALSE(means.nearest({bad, 0}).has_value());
    CHECK(support::allocations() == before);
}

TEST_CASE("class_means: the spread of a class, learnt touch by touch") {
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    constexpr std::size_t touches = 40;
    means_type means;
    CHECK(means.spread(0) == 1);
    std::vector<means_type::point> points(touches);
    std::array<double, 2> mean{};
    for (auto& point : points) {
        point = {100 + normal(random), 3 * normal(random)};
        CHECK(means.learn(1, point));
        for (std::size_t d = 0; d < 2; ++d)
            mean[d] += static_cast<double>(point[d]) / touches;
    }
    double squares = 0;
    for (const auto& point : points)
        for (std::size_t d = 0; d < 2; ++d)
            squares += (static_cast<double>(point[d]) - mean[d]) * (static_cast<double>(point[d]) - mean[d]);
    CHECK(means.spread(1) == doctest::Approx(squares / touches).epsilon(1e-9)); // the only class
    CHECK(means.learn(3, {0, 0}));
    CHECK(means.spread(3) == doctest::Approx(squares / touches * 8 / 9)); // of one touch: the average
    means_type after;
    CHECK(after.restore(means.save()) == restore_status::ok);
    CHECK(after.spread(1) == means.spread(1));
    CHECK(after.spread(3) == means.spread(3));
    means.forget(1);
    CHECK(means.spread(1) == 1);
    CHECK(means.spread(9) == 1);
}

} // namespace
