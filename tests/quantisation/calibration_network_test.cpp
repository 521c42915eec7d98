#include "pair.hpp"

#include <tactnet/quantisation/calibration.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace tactnet;
using support::first_weight;
using support::second_weight;

// The parts of calibration one after the other: words, ranges, weights.

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
        support::pair_description(), std::move(folded), 1, support::pair_images(1),
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
            support::pair_description(), std::move(folded), scale, images,
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

// Ranges are searched with outputs that a function of the ranges makes up: so it is known which are best.

namespace {

constexpr std::size_t places = 3; // of the mean and what words hold

/// Two maps with ranges of their own between an input and an output, each twice its input. Folded numbers of
/// each step are the range that it writes.
detail::calibration_graph chain_description() {
    detail::calibration_graph net;
    net.ranges = 4; // of which no map has the second
    std::size_t map = net.add_map({1, 1}, 0), folded = places;
    for (const std::size_t range : {std::size_t{1}, std::size_t{3}, detail::calibration_graph::none}) {
        detail::graph_node step{
            .reference = [](const float*, const float* in, const float*, float* out) { *out = 2 * *in; },
            .input = map,
            .folded = folded};
        map = step.output = net.add_map({1, 1}, range);
        if (range != detail::calibration_graph::none) {
            step.set_ranges = [](float* to, const step_ranges& of) { of.output.write(to); };
            folded += 2;
        }
        net.nodes.push_back(step);
    }
    return net;
}
const std::vector<float> searched_images{-51,
                                         204}; // so maps hold −102 … 408 and −204 … 816: steps of 2 and 4
std::vector<float> folded_numbers() {
    return {0, 128, 255, 0, 0, 0, 0};
}
std::size_t calls;

struct found_ranges {
    std::vector<float> folded;
    std::vector<map_range> ranges;
    double error;
};
found_ranges searched(detail::run_quantised recognise) {
    calls = 0;
    const detail::calibration_graph net = chain_description();
    std::vector<float> folded = folded_numbers();
    const detail::activation_observer seen(net, folded, 1, searched_images);
    const detail::range_search found(net, seen, 1, recognise, folded);
    return {folded, {found.ranges().begin(), found.ranges().end()}, found.error()};
}
/// Outputs that are off by as much.
bool off_by(float difference, std::span<const float> shown, std::span<float> to) {
    ++calls;
    for (std::size_t i = 0; i < to.size(); ++i)
        to[i] = 8 * shown[i] + difference;
    return true;
}

} // namespace

TEST_CASE("range_search: where outputs do not depend on ranges, these are full") {
    const found_ranges found = searched([](std::span<const float>, std::span<const float> shown,
                                           std::span<float> to) { return off_by(3, shown, to); });
    CHECK(found.error == 9);
    // 255 steps from the lowest to the highest, and of the words a step of 1/128.
    CHECK(found.folded == std::vector<float>{0, 128, 255, 2, 51, 4, 51});
    REQUIRE(found.ranges.size() == 4);
    CHECK(found.ranges[0].scale == 1.0f / 128);
    CHECK(found.ranges[1].scale == 2);
    CHECK(found.ranges[3].scale == 4);
    // Once in front, then in two sweeps each of two maps with each of eight fractions.
    CHECK(calls == 1 + 2 * 2 * 8);
}

TEST_CASE("range_search: each map gets the fraction with which outputs come nearest") {
    // Best with steps of 1.6 and 2.8: 0.8 and 0.7 of the full ones.
    const found_ranges found = searched([](std::span<const float> folded, std::span<const float> shown,
                                           std::span<float> to) {
        return off_by(std::abs(folded[places] - 1.6f) + std::abs(folded[places + 2] - 2.8f) + 1, shown, to);
    });
    CHECK(found.folded[places] == 1.6f);
    CHECK(found.folded[places + 2] == 2.8f);
    // The zero stays where it is: both ends are cut by the same fraction.
    CHECK(found.folded[places + 1] == 51);
    CHECK(found.folded[places + 3] == 51);
    CHECK(found.ranges[1].scale == 1.6f);
    CHECK(found.ranges[3].scale == 2.8f);
    CHECK(found.error == 1);
}

TEST_CASE("range_search: a second sweep searches each range given those that were found") {
    // A narrow range of the first map is better once the second is narrow, and not before.
    const found_ranges found =
        searched([](std::span<const float> folded, std::span<const float> shown, std::span<float> to) {
            const bool narrow_first = folded[places] < 1.1f, narrow_second = folded[places + 2] < 2.1f;
            return off_by(narrow_first ? (narrow_second ? 1.0f : 9.0f) : (narrow_second ? 4.0f : 5.0f), shown,
                          to);
        });
    CHECK(found.folded[places] == 1);
    CHECK(found.folded[places + 2] == 2);
    CHECK(found.error == 1);
}

TEST_CASE("range_search: ranges with which a frame would be rejected are not chosen") {
    const found_ranges found =
        searched([](std::span<const float> folded, std::span<const float> shown, std::span<float> to) {
            return off_by(folded[places], shown, to) && folded[places] > 1.5f;
        });
    CHECK(found.folded[places] == 1.6f);
    CHECK(std::isfinite(found.error));
}
