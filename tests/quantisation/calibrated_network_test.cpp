#include "pair.hpp"

#include <tactnet/quantisation/calibrated_network.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

// The parts of calibration one after the other: words, ranges, weights.

using namespace tactnet;
using support::first_weight;
using support::second_weight;

namespace {

/// What is found for one filter over two inputs, given the error that each weight makes.
struct judged_pair {
    std::vector<float> folded;
    double error, error_of_rounded;
    std::size_t maps;
};
/// All of these are exact: whole inputs up to 210, weights of ten bits.
judged_pair judge_pairs(float told) {
    static float error_of_fitted;
    error_of_fitted = told;
    std::vector<float> folded{0, 0, 0, 0, first_weight, second_weight, 0, 1};
    const detail::calibrated_network found(
        support::pair_description(0), std::move(folded), 1, support::pair_images(1),
        [](std::span<const float> numbers, std::span<const float> shown, std::span<float> to) {
            const bool fitted = numbers[5] != second_weight;
            for (std::size_t i = 0; i < to.size(); ++i)
                to[i] = shown[2 * i] * first_weight + shown[2 * i + 1] * second_weight +
                        (fitted ? error_of_fitted : 2);
            return true;
        });
    return {{found.folded().begin() + 4, found.folded().end()},
            found.error(),
            found.error_of_rounded(),
            found.maps()};
}

void refuses(std::vector<float> folded, float scale, std::vector<float> images, const char* text) {
    CHECK_THROWS_WITH_AS(
        static_cast<void>(detail::calibrated_network(
            support::pair_description(0), std::move(folded), scale, images,
            [](std::span<const float>, std::span<const float>, std::span<float>) { return true; })),
        doctest::Contains(text), std::invalid_argument);
}

} // namespace

TEST_CASE("calibrated_network: fitted weights are kept if outputs come nearer, and only then") {
    const judged_pair better = judge_pairs(1), no_better = judge_pairs(2), worse = judge_pairs(3);
    for (const judged_pair& each : {better, no_better, worse}) {
        CHECK(each.error_of_rounded == 4);
        CHECK(each.maps == 0);
    }
    CHECK(better.error == 1);
    CHECK(better.folded[0] == 124);
    CHECK(better.folded[1] == 1);
    for (const judged_pair& each : {no_better, worse}) {
        CHECK(each.error == 4);
        CHECK(each.folded[0] == first_weight);
        CHECK(each.folded[1] == second_weight);
        CHECK(each.folded[2] == 0);
    }
}

TEST_CASE("calibrated_network: numbers that no network has are rejected, and the error names them") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> right{0, 0, 0, 0, 1, 1, 0, 1}, images(16, 1.0f);
    for (const float broken : {nan, 2e30f, -2e30f, std::numeric_limits<float>::infinity()}) {
        for (const std::size_t place : {0u, 1u}) {
            std::vector<float> folded = right;
            folded[place] = broken;
            refuses(folded, 1, images, "expected a mean and a scale that give finite numbers up to 1e30");
        }
        refuses(right, broken, images, "expected a mean and a scale that give finite numbers up to 1e30");
        for (const std::size_t place : {4u, 5u, 6u}) {
            std::vector<float> folded = right;
            folded[place] = broken;
            refuses(folded, 1, images, "expected parameters and variances + epsilon above zero that give");
        }
        std::vector<float> shown = images;
        shown[7] = broken;
        refuses(right, 1, shown, "found number 3 of those taken broken");
    }
}

TEST_CASE("set_words: as many steps as fit, a power of two, and what they hold") {
    const auto words = [](float mean, std::vector<float> images) {
        std::vector<float> folded{mean, 0, 0};
        detail::set_words(1, images, folded);
        return std::pair(folded[1], folded[2]);
    };
    // 32700 steps at most: 255 × 128 = 32640 fit, 256 × 128 do not.
    CHECK(words(0, {0}) == std::pair(128.0f, 32700 / 128.0f));
    CHECK(words(0, {255}) == std::pair(128.0f, 32700 / 128.0f));
    CHECK(words(0, {256}) == std::pair(64.0f, 32700 / 64.0f));
    CHECK(words(1, {-255}) == std::pair(64.0f, 32700 / 64.0f));
    // Counts that no image has may come still: the mean alone makes them far.
    CHECK(words(-1, {0}) == std::pair(64.0f, 32700 / 64.0f));
    CHECK(words(256, {255}) == std::pair(64.0f, 32700 / 64.0f));
    for (const float count : {1e4f, 1e9f, 1e20f, 1e30f}) {
        const auto [steps, most] = words(0, {3, count, 5});
        CHECK(steps * count <= 32700);
        CHECK(2 * steps * count > 32700);
        CHECK(most >= count);
    }
    // It ends, and so can what is broken be refused.
    CHECK(words(0, {std::numeric_limits<float>::infinity()}).first > 0);
}
