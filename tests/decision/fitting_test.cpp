#include <tactnet/decision/fitting.hpp>
#include <tactnet/decision/probabilities.hpp>
#include <tactnet/decision/touch_evidence.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <support/error_of.hpp>
#include <vector>

namespace {

using namespace tactnet;

constexpr std::size_t outputs = 6, classes = 5;

struct samples {
    std::vector<float> logits;
    std::vector<std::size_t> labels;
};
/// Images whose classes have the probabilities of a softmax at a temperature.
samples draw(std::size_t count, double temperature, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> logit(0, 3);
    samples drawn;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<double, classes> shares{};
        for (std::size_t c = 0; c < classes; ++c) {
            drawn.logits.push_back(logit(random));
            shares[c] = std::exp(static_cast<double>(drawn.logits.back()) / temperature);
        }
        drawn.logits.push_back(100); // an output that stands for nothing
        drawn.labels.push_back(std::discrete_distribution<std::size_t>(shares.begin(), shares.end())(random));
    }
    return drawn;
}
reliability_diagram of(const samples& images, const temperature_scaling& scaling) {
    reliability_diagram found;
    for (std::size_t i = 0; i < images.labels.size(); ++i) {
        const auto most = scaling.classify(std::span(images.logits).subspan(i * outputs, outputs), classes);
        REQUIRE(most.has_value());
        found.add(most->probability, most->index == images.labels[i]);
    }
    return found;
}
std::string error_of(std::span<const float> logits, std::span<const std::size_t> labels) {
    return support::error_of<std::invalid_argument>(
        [&] { (void)fit_temperature(logits, outputs, labels, classes); });
}

TEST_CASE("fit_temperature: recovers the temperature of the labels, and corrects the calibration") {
    for (const double temperature : {0.5, 1.0, 2.5}) {
        const samples held_out = draw(20'000, temperature, 1), test = draw(20'000, temperature, 2);
        const temperature_scaling found = fit_temperature(held_out.logits, outputs, held_out.labels, classes);
        CAPTURE(temperature);
        CHECK(found.temperature == doctest::Approx(temperature).epsilon(0.05));
        // 15 bins of 20 000 samples: about 15 × 0.4 / √(20 000 · 15) for calibrated ones.
        CHECK(of(test, found).calibration_error() < 0.015);
        if (temperature != 1) {
            CHECK(of(test, {1}).calibration_error() > 0.05);
            CHECK(of(test, {1}).brier_score() > of(test, found).brier_score());
        }
    }
}

TEST_CASE("fit_temperature: stays near 1 with few images, and finite where all are right or all are wrong") {
    const samples few = draw(3, 0.2, 3);
    CHECK(fit_temperature(few.logits, outputs, few.labels, classes).temperature ==
          doctest::Approx(1).epsilon(0.3));
    samples all = draw(1000, 1, 4);
    for (std::size_t i = 0; i < all.labels.size(); ++i)
        all.labels[i] = first_largest(std::span(all.logits).subspan(i * outputs, classes));
    const double right = fit_temperature(all.logits, outputs, all.labels, classes).temperature;
    CHECK(right > 0.05);
    CHECK(right < 0.5);
    for (std::size_t& label : all.labels)
        label = (label + 1) % classes;
    const double wrong = fit_temperature(all.logits, outputs, all.labels, classes).temperature;
    CHECK(wrong > 3);
    CHECK(wrong < 20.001);
}

TEST_CASE("fit_temperature: every image counts, in any order, also where every output stands for a class") {
    // One image is right by a margin of 4, one wrong by 1: the least of 10 log² T + log(1 + e^(−4/T)) + log(1
    // + e^(1/T)).
    const std::array<float, 4> logits{4, 0, 0, 1}, turned{0, 1, 4, 0};
    const std::array<std::size_t, 2> labels{0, 0};
    const double found = fit_temperature(logits, 2, labels, 2).temperature;
    CHECK(fit_temperature(turned, 2, labels, 2).temperature == doctest::Approx(found).epsilon(1e-7));
    const auto loss = [](double t) {
        return 10 * std::log(t) * std::log(t) + std::log1p(std::exp(-4 / t)) + std::log1p(std::exp(1 / t));
    };
    CHECK(loss(found) < loss(found * 1.001));
    CHECK(loss(found) < loss(found / 1.001));
}

TEST_CASE("fit_temperature: refuses what it cannot fit") {
    const samples images = draw(4, 1, 5);
    CHECK(error_of({}, {}) ==
          "fit_temperature: expected images with a row of 6 logits each, of which 5 stand for a "
          "class, found 0 labels and 0 logits");
    CHECK(error_of(std::span(images.logits).first(23), images.labels)
              .ends_with("found 4 labels and 23 logits"));
    std::vector<std::size_t> labels = images.labels;
    labels[2] = 5;
    CHECK(error_of(images.logits, labels) == "fit_temperature: expected labels below 5, found 5");
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<float> logits = images.logits;
        logits[3 * outputs + 1] = bad;
        CHECK(error_of(logits, images.labels) ==
              "fit_temperature: expected finite logits, found others for image 3");
    }
}

TEST_CASE("temperature_scaling: probabilities of a softmax of logits ÷ temperature, of the same class") {
    const std::array<float, 3> logits{1, 3, 2};
    for (const double temperature : {0.5, 1.0, 4.0}) {
        const temperature_scaling scaling{temperature};
        const double sum = std::exp(1 / temperature) + std::exp(3 / temperature) + std::exp(2 / temperature);
        const auto found = scaling.classify(logits, 3);
        REQUIRE(found.has_value());
        CHECK(found->index == 1);
        CHECK(found->probability == doctest::Approx(std::exp(3 / temperature) / sum).epsilon(1e-12));
        std::array<double, 3> logarithms{};
        REQUIRE(scaling.log_probabilities(logits, logarithms));
        for (std::size_t c = 0; c < 3; ++c)
            CHECK(
                logarithms[c] ==
                doctest::Approx(static_cast<double>(logits[c]) / temperature - std::log(sum)).epsilon(1e-12));
    }
    CHECK(temperature_scaling{}.classify(logits, 3)->probability == classify_logits(logits, 3)->probability);
    const std::array<float, 2> broken{0, std::numeric_limits<float>::quiet_NaN()};
    CHECK_FALSE(temperature_scaling{}.classify(broken, 2).has_value());
    std::array<double, 2> logarithms{7, 7};
    CHECK_FALSE(temperature_scaling{}.log_probabilities(broken, logarithms));
    CHECK(logarithms[0] == 7);
}

TEST_CASE("temperature_scaling: a temperature that gives no finite numbers gives no answer") {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                     infinity = std::numeric_limits<double>::infinity();
    const std::array<float, 3> logits{-3e38F, 3e38F, 2};
    std::array<double, 3> logarithms{7, 7, 7};
    std::array<bool, 3> members{};
    const std::vector<std::size_t> labels{1};
    for (const double temperature : {0.0, -1.0, nan, infinity, 1e-320, 9e-4, 1001.0}) {
        CAPTURE(temperature);
        const temperature_scaling scaling{temperature};
        CHECK_FALSE(scaling.classify(logits, 3).has_value());
        CHECK_FALSE(scaling.log_probabilities(logits, logarithms));
        CHECK(logarithms[0] == 7);
        CHECK(prediction_set(scaling, 0.1).predict(logits, members) == 0);
        touch_evidence<3> evidence(3, scaling);
        CHECK_FALSE(evidence.add_frame(logits));
        CHECK_FALSE(evidence.most_likely().has_value());
        CHECK_THROWS_AS((void)fit_prediction_set(scaling, 0.9, logits, 3, labels, 3), std::invalid_argument);
    }
    for (const double temperature : {1e-3, 1.0, 1e3})
        for (const double correlation : {-1.0, 0.5, nan, infinity}) {
            const temperature_scaling scaling{temperature};
            REQUIRE(scaling.log_probabilities(logits, logarithms));
            CHECK(std::ranges::all_of(logarithms, [](double value) { return std::isfinite(value); }));
            touch_evidence<3> evidence(3, scaling, {correlation, correlation});
            CHECK(evidence.add_frame(logits));
            CHECK(evidence.add_frame(logits));
            CHECK(evidence.most_likely()->index == 1);
            CHECK(evidence.most_likely()->probability == 1);
        }
}

TEST_CASE("reliability_diagram: what several took, and what was kept, is the same as taken by one") {
    reliability_diagram one, first, second;
    for (int i = 0; i < 40; ++i) {
        const double probability = (i % 37) / 36.0;
        one.add(probability, i % 3 == 0);
        (i < 25 ? first : second).add(probability, i % 3 == 0);
    }
    first.add(second);
    const reliability_diagram kept(first.bins());
    for (std::size_t b = 0; b < reliability_diagram::bin_count; ++b) {
        CHECK(kept.bins()[b].count == one.bins()[b].count);
        CHECK(kept.bins()[b].right == one.bins()[b].right);
    }
    CHECK(kept.calibration_error() == doctest::Approx(one.calibration_error()));
    CHECK(kept.brier_score() == doctest::Approx(one.brier_score()));
}

TEST_CASE("reliability_diagram: bins, calibration error and Brier score, by hand") {
    reliability_diagram found;
    CHECK(found.calibration_error() == 0);
    CHECK(found.brier_score() == 0);
    found.add(0.95, true);
    found.add(0.95, false);
    found.add(0.5, true);
    found.add(0, false);
    found.add(std::numeric_limits<double>::quiet_NaN(), true);
    CHECK(found.bins()[14].count == 2);
    CHECK(found.bins()[14].accuracy() == 0.5);
    CHECK(found.bins()[14].mean_probability() == doctest::Approx(0.95));
    CHECK(found.bins()[7].right == 1);
    CHECK(found.bins()[0].count == 1);
    CHECK(found.calibration_error() == doctest::Approx((2 * 0.45 + 0.5 + 0) / 4));
    CHECK(found.brier_score() == doctest::Approx((0.05 * 0.05 + 0.95 * 0.95 + 0.25 + 0) / 4));
    found.add(1.5, true); // as 1
    CHECK(found.bins()[14].count == 3);
}

/// Images that a network recognises not too well, and is too sure of.
samples draw_too_sure(std::size_t count, std::mt19937& random) {
    std::normal_distribution<float> noise(0, 4);
    samples drawn;
    for (std::size_t i = 0; i < count; ++i) {
        drawn.labels.push_back(random() % outputs);
        for (std::size_t c = 0; c < outputs; ++c)
            drawn.logits.push_back(noise(random) + (c == drawn.labels.back() ? 10.0F : 0.0F));
    }
    return drawn;
}

TEST_CASE("prediction_set: holds the right class as often as promised, whatever the temperature") {
    std::mt19937 random(3);
    for (const double temperature : {0.3, 1.0, 5.0})
        for (const double coverage : {0.8, 0.95, 0.99}) {
            constexpr std::size_t draws = 60, images = 400;
            std::size_t held = 0, tried = 0, members_in_all = 0;
            for (std::size_t d = 0; d < draws; ++d) {
                const samples held_out = draw_too_sure(200, random), test = draw_too_sure(images, random);
                const auto set = fit_prediction_set({temperature}, coverage, held_out.logits, outputs,
                                                    held_out.labels, outputs);
                for (std::size_t i = 0; i < images; ++i) {
                    std::array<bool, outputs> members{};
                    members_in_all +=
                        set.predict(std::span(test.logits).subspan(i * outputs, outputs), members);
                    held += members[test.labels[i]];
                }
                tried += images;
            }
            CAPTURE(temperature);
            CAPTURE(coverage);
            // Of n = 200 held-out images, the coverage has a deviation of √(coverage (1 − coverage) ÷ 202)
            // per draw.
            const double deviation =
                std::sqrt(coverage * (1 - coverage) * (1.0 / 202 / draws + 1.0 / static_cast<double>(tried)));
            const double found = static_cast<double>(held) / static_cast<double>(tried);
            CHECK(found >= coverage - 4 * deviation);
            // At most 1 ÷ 201 more than promised, but for the most likely class, which is always in.
            if (coverage > 0.9)
                CHECK(found <= coverage + 1.0 / 201 + 4 * deviation);
            CHECK(members_in_all >= tried);
        }
}

TEST_CASE("prediction_set: members by hand") {
    const prediction_set set({}, 0.2);
    std::array<bool, 3> members{true, true, true};
    const auto logarithm = [](double share) { return static_cast<float>(std::log(share)); };
    CHECK(set.predict(std::array{logarithm(0.5), logarithm(0.3), logarithm(0.19)}, members) == 2);
    CHECK(members == std::array{true, true, false});
    CHECK(set.predict(std::array{0.0F, std::numeric_limits<float>::quiet_NaN(), 0.0F}, members) == 0);
    CHECK(members == std::array{false, false, false});
    CHECK(set.predict(std::array{3000.0F, 2999.5F, 0.0F}, members) == 2); // no overflow
    const prediction_set sure({}, 0.99); // the most likely class all the same
    CHECK(sure.predict(std::array{0.0F, 1.0F, 0.0F}, members) == 1);
    CHECK(members == std::array{false, true, false});
}

TEST_CASE("prediction_set: of few images, all classes; of too few or wrong ones, an error") {
    std::mt19937 random(4);
    const samples few = draw_too_sure(18, random);
    const auto all = fit_prediction_set({}, 0.95, few.logits, outputs, few.labels, outputs);
    CHECK(all.least_probability() == 0);
    std::array<bool, outputs> members{};
    CHECK(all.predict(std::span(few.logits).first(outputs), members) == outputs);
    const samples enough = draw_too_sure(19, random);
    CHECK(fit_prediction_set({}, 0.95, enough.logits, outputs, enough.labels, outputs).least_probability() >
          0);
    const auto error = [](double coverage, const samples& images) {
        return support::error_of<std::invalid_argument>(
            [&] { (void)fit_prediction_set({}, coverage, images.logits, outputs, images.labels, outputs); });
    };
    for (const double coverage : {0.0, 1.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        CHECK(error(coverage, few)
                  .starts_with("fit_prediction_set: expected a coverage above 0 and below 1, found"));
    CHECK(error(0.9, {}).starts_with("fit_prediction_set: expected images with a row of 6 logits each"));
}

} // namespace
