#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/quantisation/activation_observer.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

// What maps hold and outputs are, of a network small enough to reckon by hand.

using namespace tactnet;

namespace {

/// Of two inputs a and b, a map of two channels, a + 2 b and −a + 1, then the rectified map, which shares its
/// range; and outputs, channel 0 − channel 1 and the sum of both.
detail::calibration_graph description() {
    detail::calibration_graph net;
    net.ranges = 2;
    const std::size_t frame = net.add_map({1, 2}, 0), sums = net.add_map({1, 1, 2}, 1),
                      rectified = net.add_map({1, 1, 2}, 1),
                      outputs = net.add_map({1, 1, 2}, detail::calibration_graph::none);
    static constexpr kernels::frame_convolution first{
        .window = {{1, 2}, extent2d(1, 2), 1}, .filters = 2, .input_stride = 1},
        third{.window = {{1, 1, 2}, extent2d(1, 1), 1}, .filters = 2, .input_stride = 2};
    const auto rectify = [](const float*, const float* in, const float*, float* out) {
        out[0] = std::max(in[0], 0.0f), out[1] = std::max(in[1], 0.0f);
    };
    net.nodes = {{.convolution = &first, .input = frame, .output = sums, .folded = 4},
                 {.reference = rectify, .input = sums, .output = rectified},
                 {.convolution = &third, .input = rectified, .output = outputs, .folded = 12}};
    return net;
}
/// The mean frame, what words hold, then weights [filter][tap], biases, scales of each convolution.
const std::vector<float> folded{10, 20, 128, 255, 1, 2, -1, 0, 0, 1, 1, 1, 1, -1, 1, 1, 0, 0, 1, 1};

} // namespace

TEST_CASE("activation_observer: the least and the largest number of all maps of a range, and all outputs") {
    // Inputs (count − mean) / 2: (3, −1), (−5, 2), so sums (1, −2), (−1, 6).
    const std::vector<float> images{16, 18, 0, 24};
    const detail::activation_observer seen(description(), folded, 0.5f, images);
    CHECK(seen.lowest(1) == -2);
    CHECK(seen.highest(1) == 6);
    CHECK(std::vector<float>(seen.outputs().begin(), seen.outputs().end()) ==
          std::vector<float>{1, 1, -6, 6});
    // A range holds 0, whatever its numbers are: of (4, 2), sums (8, −3); of (−1, −1), (−3, 2).
    const detail::activation_observer above(description(), folded, 0.5f, std::vector<float>{10, 20});
    CHECK(above.lowest(1) == 0);
    CHECK(above.highest(1) == 1);
}

TEST_CASE("activation_observer: where a softmax ends the network, outputs are probabilities") {
    detail::calibration_graph net = description();
    const auto softmax = [](const float*, const float*, const float*, float* out) {
        kernels::softmax_of<float>(std::span<const float>(out, 2), std::span(out, 2));
    };
    net.nodes.push_back({.reference = softmax, .input = 3, .output = 3});
    const detail::activation_observer seen(net, folded, 0.5f, std::vector<float>{16, 18, 0, 24});
    // Of scores (1, 1) and (−6, 6). Each of the exponential, the sum and the quotient is rounded once or
    // twice: 8 roundings of 2⁻²⁴.
    const double less = 1 / (1 + std::exp(12.0));
    const std::array<double, 4> expected{0.5, 0.5, less, 1 - less};
    for (std::size_t o = 0; o < 4; ++o)
        CHECK(std::abs(static_cast<double>(seen.outputs()[o]) - expected[o]) <= 8 * 0x1p-24 * expected[o]);
}

TEST_CASE(
    "activation_observer: the error is the mean square over all outputs, infinite if a frame is refused") {
    const detail::activation_observer seen(description(), folded, 0.5f, std::vector<float>{16, 18, 0, 24});
    // Outputs are 1, 1, −6, 6.
    CHECK(
        seen.error_of(
            [](std::span<const float> numbers, std::span<const float> images, std::span<float> to) {
                CHECK(numbers.data() == folded.data());
                CHECK(std::vector<float>(images.begin(), images.end()) == std::vector<float>{16, 18, 0, 24});
                to[0] = 1, to[1] = 4, to[2] = -6, to[3] = 5;
                return true;
            },
            folded) == 2.5);
    CHECK(
        seen.error_of([](std::span<const float>, std::span<const float>, std::span<float>) { return false; },
                      folded) == std::numeric_limits<double>::infinity());
}

TEST_CASE("activation_observer: each image has its outputs, also those after the last group of sixteen") {
    std::vector<float> images;
    for (std::size_t i = 1; i <= 37; ++i) // inputs (i, 0), so sums (i, 1 − i) and outputs (i, i)
        images.insert(images.end(), {10 + 2 * static_cast<float>(i), 20});
    const detail::activation_observer seen(description(), folded, 0.5f, images);
    REQUIRE(seen.outputs().size() == 2 * 37);
    for (std::size_t o = 0; o < 2 * 37; ++o)
        CHECK(seen.outputs()[o] == static_cast<float>(o / 2 + 1));
}

TEST_CASE("activation_observer: of many images some in even distances are observed") {
    constexpr std::size_t most = detail::activation_observer::max_observed;
    std::vector<float> many;
    for (std::size_t i = 0; i < 3 * most; ++i) { // of three, the first is taken
        const auto x = static_cast<float>(i / 3);
        many.insert(many.end(), {i % 3 == 0 ? x : 1e6f, 20});
    }
    const detail::activation_observer seen(description(), folded, 0.5f, many);
    REQUIRE(seen.outputs().size() == 2 * most);
    CHECK(seen.highest(1) == 122.5); // (255 − 10) / 2
    CHECK(seen.outputs()[0] == -6);  // of (−5, 0), sums (−5, 6)
    CHECK(seen.outputs()[2 * most - 1] == 122.5);
}

TEST_CASE("activation_observer: images that give no finite outputs are refused, by their place among all") {
    std::vector<float> images(2 * 600, 15.0f);
    const auto refused = [&](std::size_t which) {
        CHECK_THROWS_WITH_AS(
            static_cast<void>(detail::activation_observer(description(), folded, 1e20f, images)),
            doctest::Contains(("found number " + std::to_string(which) + " of those taken broken").c_str()),
            std::invalid_argument);
    };
    CHECK_NOTHROW(static_cast<void>(detail::activation_observer(description(), folded, 1, images)));
    for (const float broken :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.1e30f}) {
        images[2 * 7 + 1] = broken; // also of images that are not observed
        refused(7);
    }
    images[2 * 7 + 1] = 15;
    // Observed are 0, 2, 4, 7, 9, 11, 14 … of 600; 14 × 10²⁹ times 10²⁰ is too much for a float.
    images[2 * 14] = 9e29f;
    refused(14);
}
