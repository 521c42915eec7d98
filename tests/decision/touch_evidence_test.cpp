#include <tactnet/decision/touch_evidence.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

using namespace tactnet;

namespace {

using logits = std::array<float, 4>;

double probability_of(const logits& sums, std::size_t classes) {
    double all = 0, most = 0;
    for (std::size_t c = 0; c < classes; ++c) {
        all += std::exp(static_cast<double>(sums[c]));
        most = std::max(most, std::exp(static_cast<double>(sums[c])));
    }
    return most / all;
}

} // namespace

TEST_CASE("touch_evidence: frames of a grasp and grasps of an object count by their correlation") {
    const logits first{1, 2, 0, 9}, second{3, 1, 0, 9};
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
        const logits together{4 * share, 3 * share, 0, 9};
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
    (void)evidence.add_frame(logits{1, 2, 0, 4});
    CHECK(evidence.most_likely()->probability == doctest::Approx(probability_of({0.5f, 1, 0, 2}, 4)));
}

TEST_CASE("touch_evidence: a frame that is not finite is not taken") {
    touch_evidence<4> evidence;
    CHECK_FALSE(evidence.add_frame(logits{0, 0, std::numeric_limits<float>::quiet_NaN(), 0}));
    CHECK_FALSE(evidence.add_frame(logits{0, std::numeric_limits<float>::infinity(), 0, 0}));
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
                logits found{};
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
