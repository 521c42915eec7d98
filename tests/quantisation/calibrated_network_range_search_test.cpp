#include <tactnet/quantisation/calibrated_network.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

// Ranges are searched with outputs that a function of the ranges makes up: so it is known which are best.

using namespace tactnet;

namespace {

constexpr std::size_t places = 3; // of the mean and what words hold

/// Two maps with ranges of their own between an input and an output, each twice its input. Folded numbers of
/// each step are the range that it writes.
detail::calibration_graph description() {
    detail::calibration_graph net;
    net.ranges = 4; // of which no map has the second
    std::size_t map = net.add_map({1, 1}, 0), folded = places;
    for (const std::size_t range : {std::size_t{1}, std::size_t{3}, detail::calibration_graph::none}) {
        detail::graph_node step{.reference = [](const detail::graph_node&, const float*, const float* in,
                                                float* out) { *out = 2 * *in; },
                                .input = map};
        step.from = step.to = {1, 1}, step.folded = folded;
        map = step.output = net.add_map({1, 1}, range);
        if (range != detail::calibration_graph::none) {
            step.set_ranges = [](float* to, const step_ranges& of) { of.output.write(to); };
            folded += 2;
        }
        net.nodes.push_back(step);
    }
    return net;
}
const std::vector<float> images{-51, 204}; // so maps hold −102 … 408 and −204 … 816: steps of 2 and 4
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
    const detail::calibration_graph net = description();
    std::vector<float> folded = folded_numbers();
    const detail::activation_observer seen(net, folded, 1, images);
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
