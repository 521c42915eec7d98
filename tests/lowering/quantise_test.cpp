#include "../deployment/deployed_network.hpp"

#include <tactnet/lowering/quantise.hpp>
#include <tactnet/quantisation/calibration.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

// From folded numbers to whole ones.

using namespace tactnet;
using detail::filter_scale;

namespace {

/// The largest and the smallest sum that any input gives, on the way too: all magnitudes together.
struct worst_sums {
    double most = 0;
    explicit worst_sums(const std::vector<float>& weights, const filter_scale& scale, double largest_input,
                        bool accumulates) {
        for (const float w : weights)
            most += std::abs(static_cast<double>(detail::quantised(w, scale))) * largest_input;
        most += std::abs(static_cast<double>(scale.start)) +
                (accumulates ? 255.0 * static_cast<double>(scale.added) : 0);
    }
    [[nodiscard]] bool fits() const { return most <= std::numeric_limits<std::int32_t>::max(); }
};

filter_scale scaled(const std::vector<float>& weights, double bias, const step_ranges& ranges,
                    bool accumulates, double largest_input = 255, int offset = 0) {
    const float scale =
        detail::scale_of_filter(weights.data(), weights.size(), bias, ranges, accumulates, largest_input);
    return detail::filter_of(weights.data(), weights.size(), bias, scale, ranges, accumulates, largest_input,
                             offset);
}
/// A scale is a number of single precision: it is off by 2⁻²⁴ of itself at most, and what is reckoned with it
/// in double precision by far less.
constexpr double of_scale = 0x1p-24 + 0x1p-50;

std::vector<float> drawn(std::size_t count, float spread, std::uint64_t seed) {
    support::numbers draw(seed);
    std::vector<float> weights(count);
    for (float& w : weights)
        w = draw.next(-spread, spread);
    return weights;
}

} // namespace

TEST_CASE("nearest_even: ties go to the even number, others to the nearest") {
    for (int half = -2001; half <= 2001; ++half) {
        const double value = half / 2.0;
        CHECK(detail::nearest_even(value) == static_cast<std::int64_t>(std::nearbyint(value)));
        for (const double beside : {std::nextafter(value, 1e9), std::nextafter(value, -1e9)})
            CHECK(detail::nearest_even(beside) == static_cast<std::int64_t>(std::nearbyint(beside)));
    }
    std::mt19937_64 draw(1);
    std::size_t wrong = 0;
    for (int i = 0; i < 100'000; ++i) {
        const double value = std::ldexp(static_cast<double>(static_cast<std::int64_t>(draw())),
                                        -static_cast<int>(draw() % 70) - 2);
        wrong += detail::nearest_even(value) != static_cast<std::int64_t>(std::nearbyint(value));
    }
    CHECK(wrong == 0);
}

TEST_CASE("scale_of_filter: the largest weight is 127 steps") {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const std::vector<float> weights = drawn(25, 0.3f, seed);
        const step_ranges ranges{{0.02f, 3}, {}, {0.05f, 9}};
        const filter_scale scale = scaled(weights, 0.1, ranges, false);
        double largest = 0;
        int most = 0;
        for (const float w : weights) {
            largest = std::max(largest, std::abs(static_cast<double>(w)));
            most = std::max(most, std::abs(static_cast<int>(detail::quantised(w, scale))));
            // No weight is off by more than half a step; quotient and product, of up to 127 steps, are
            // rounded in double precision.
            CHECK(std::abs(detail::quantised(w, scale) * scale.weight_scale - static_cast<double>(w)) <=
                  scale.weight_scale * (0.5 + 2 * 127 * 0x1p-53));
        }
        CHECK(most == 127);
        CHECK(scale.weight_scale == static_cast<double>(static_cast<float>(largest / 127)));
        CHECK(scale.unit == scale.weight_scale * static_cast<double>(0.02f));
        std::int64_t sum = 0;
        for (const float w : weights)
            sum += detail::quantised(w, scale);
        CHECK(scale.start == std::llround(0.1 / scale.unit) - 3 * sum);
        CHECK(scaled(weights, 0.1, ranges, false, 255, 128).start == scale.start + 128 * sum);
    }
}

TEST_CASE("scale_of_filter: no sum passes 32 bits, however many the weights and large the bias") {
    std::size_t coarser = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        support::numbers draw(seed);
        const auto count = static_cast<std::size_t>(draw.next(1, 6000));
        const std::vector<float> weights = drawn(count, std::pow(10.0f, draw.next(-12, 6)), seed);
        const double bias = std::pow(10.0, static_cast<double>(draw.next(-9, 9))) * (seed % 2 == 0 ? 1 : -1);
        const step_ranges ranges{{std::pow(10.0f, draw.next(-6, 3)), std::floor(draw.next(0, 256))},
                                 {std::pow(10.0f, draw.next(-6, 3)), std::floor(draw.next(0, 256))},
                                 {0.1f, 0}};
        for (const bool accumulates : {false, true})
            for (const bool words : {false, true}) {
                const double largest_input = words ? 32768 : 255;
                const filter_scale scale = scaled(weights, bias, ranges, accumulates, largest_input,
                                                  words           ? 0
                                                  : seed % 3 == 0 ? 128
                                                                  : 0);
                CHECK(worst_sums(weights, scale, largest_input, accumulates).fits());
                CHECK(scale.fits());
                // A bias is rounded to half a unit at most; sums below 2³¹, in double precision, to 2⁻²².
                if (!accumulates) // of which the bytes' zero is counted twice by these
                    CHECK(worst_sums(weights, scale, largest_input, accumulates).most <=
                          scale.max_abs_sum + 0.5 + 4 * 0x1p-22);
                const float largest = *std::max_element(weights.begin(), weights.end(), [](float a, float b) {
                    return std::abs(a) < std::abs(b);
                });
                coarser += std::abs(detail::quantised(largest, scale)) < 60;
                // A bias is off by half a unit at most.
                std::int64_t sum = 0;
                for (const float w : weights)
                    sum += detail::quantised(w, scale);
                const auto zero =
                    static_cast<std::int64_t>(ranges.input.zero_point) - (!words && seed % 3 == 0 ? 128 : 0);
                const double without = static_cast<double>(
                    scale.start + zero * sum +
                    (accumulates ? static_cast<std::int64_t>(ranges.added.zero_point) * scale.added : 0));
                CHECK(std::abs(without - bias / scale.unit) <= 0.5);
            }
    }
    CHECK(coarser > 0); // or no filter was near the bound
}

TEST_CASE("scale_of_filter: a byte that is added counts for what it stands") {
    std::size_t whole = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        support::numbers draw(seed);
        const std::vector<float> weights = drawn(72, std::pow(10.0f, draw.next(-12, 2)), seed);
        const step_ranges ranges{{0.03f, 0}, {std::pow(10.0f, draw.next(-5, 2)), 5}, {0.1f, 0}};
        const filter_scale scale = scaled(weights, 0.5, ranges, true);
        const auto step = static_cast<double>(ranges.added.scale);
        const double counted = static_cast<double>(scale.added) * scale.unit;
        if (scale.unit <= step * (1 + of_scale)) {
            ++whole;
            CHECK(std::abs(counted - step) <= of_scale * step);
        } else {
            // Finer than a unit: the nearest whole number of them.
            CHECK(std::abs(counted - step) <= (0.5 + of_scale) * scale.unit);
        }
        CHECK(scale.unit == scale.weight_scale * static_cast<double>(0.03f));
    }
    CHECK(whole > 100);
    CHECK(whole < 300);
}

TEST_CASE("scale_of_filter: filters of zeros keep their bias, and what is added to them") {
    const std::vector<float> zeros(40);
    const step_ranges ranges{{0.02f, 100}, {0.3f, 7}, {0.05f, 9}};
    const filter_scale plain = scaled(zeros, 1.25, ranges, false);
    CHECK(std::abs(static_cast<double>(plain.start) * plain.unit - 1.25) <= 0.5 * plain.unit);
    CHECK(plain.unit <= 1.25 * 0x1p-27); // or half of one would be much
    const filter_scale nothing = scaled(zeros, 0, ranges, false);
    CHECK(nothing.start == 0);
    CHECK(std::isfinite(nothing.unit));
    const filter_scale summed = scaled(zeros, 1.5, ranges, true);
    CHECK(std::abs(static_cast<double>(summed.added) * summed.unit - static_cast<double>(0.3f)) <=
          of_scale * static_cast<double>(0.3f));
    for (const filter_scale& scale : {plain, summed})
        CHECK(detail::quantised(0.0f, scale) == 0);
}

// Packed when compiling, as headers for firmware are.
namespace {

using tiny = network<shape{4, 4}, conv2d<3, 3>, relu, max_pool<2>, dense<2>>;
using tiny_view = deployed<tiny, eight_bit>::view_type;
constexpr std::array<float, tiny_view::folded_elements> tiny_folded = [] {
    std::array<float, tiny_view::folded_elements> folded{};
    for (std::size_t i = 0; i < folded.size(); ++i)
        folded[i] = static_cast<float>(static_cast<int>(i * 37 % 101) - 50) / 64;
    folded[16] = 64, folded[17] = 500; // steps of a count, the largest count
    constexpr map_range input{1.0f / 64, 0}, between{0.5f, 3};
    using first = tiny_view::steps::at<0>;
    using last = tiny_view::steps::at<tiny_view::steps::size - 1>;
    first::set_ranges(folded.data() + tiny_view::steps_folded, {input, {}, between});
    last::set_ranges(folded.data() + tiny_view::steps_folded + first::folded_elements, {between, {}, {}});
    return folded;
}();
constexpr tiny_view::packed_weights tiny_packed = tiny_view::pack(tiny_folded);
static_assert(std::any_of(tiny_packed.elements.begin(), tiny_packed.elements.end(),
                          [](std::int8_t n) { return n == 127 || n == -127; }));

} // namespace

TEST_CASE("deployed_view: what is packed when compiling gives the bits of what is packed when running") {
    const deployed<tiny, eight_bit> running{std::span<const float, tiny_view::folded_elements>(tiny_folded)};
    const tiny_view compiled(tiny_packed);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<std::uint8_t> counts = support::make_frame(16, seed);
        std::array<float, 2> a{}, b{1, 1};
        CHECK(running.infer(tensor_view<const std::uint8_t, tiny::input_shape>(counts.data()), a) ==
              frame_status::ok);
        CHECK(compiled.infer(tensor_view<const std::uint8_t, tiny::input_shape>(counts.data()), b) ==
              frame_status::ok);
        CHECK(a == b);
    }
}
