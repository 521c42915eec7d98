#include <tactnet/quantisation/filter_rounding.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <utility>
#include <vector>

// Moments of pixels, and the weights found by them, compared with the pixels themselves and with all others
// that there are.

using namespace tactnet;
using detail::filter_rounding;
using detail::pixel_moments;

namespace {

/// Pixels whose inputs go together, in quarters, so that sums of products are exact.
struct drawn_pixels {
    std::size_t taps;
    std::vector<std::vector<float>> inputs; ///< [pixel][tap]
    std::vector<std::vector<float>> wanted; ///< [pixel][filter]

    drawn_pixels(std::size_t of_taps, const std::vector<std::vector<float>>& filters, unsigned seed)
        : taps(of_taps) {
        std::mt19937 draw(seed);
        const auto next = [&](unsigned below) { return static_cast<float>(draw() % below); };
        for (int pixel = 0; pixel < 64; ++pixel) {
            const float common = next(12);
            std::vector<float> in(taps), out;
            for (float& x : in)
                x = draw() % 5 == 0 ? 0 : (common + next(4)) / 4;
            for (const std::vector<float>& filter : filters) {
                float sum = 0.25f;
                for (std::size_t t = 0; t < taps; ++t)
                    sum += filter[t] * in[t];
                out.push_back(sum);
            }
            inputs.push_back(in), wanted.push_back(out);
        }
    }
    [[nodiscard]] pixel_moments moments() const {
        pixel_moments result(taps, wanted[0].size());
        for (std::size_t p = 0; p < inputs.size(); ++p) {
            std::vector<std::pair<std::size_t, float>> shown; // in any order, without zeros
            for (std::size_t t = taps; t-- > 0;)
                if (inputs[p][t] != 0)
                    shown.emplace_back(t, inputs[p][t]);
            result.add(shown, wanted[p]);
        }
        return result;
    }
    /// What a filter misses, pixel by pixel.
    [[nodiscard]] double error(std::size_t filter, std::span<const float> weights, double bias) const {
        double sum = 0;
        for (std::size_t p = 0; p < inputs.size(); ++p) {
            double missed = bias - static_cast<double>(wanted[p][filter]);
            for (std::size_t t = 0; t < taps; ++t)
                missed += static_cast<double>(weights[t]) * static_cast<double>(inputs[p][t]);
            sum += missed * missed;
        }
        return sum / static_cast<double>(inputs.size());
    }
};

/// Sums over 64 pixels of products below 2¹², and of taps of them: about 10³ roundings in double precision of
/// what is below 2²⁰ together, then divided by 64.
constexpr double of_moments = 1000 * 0x1p-53 * 0x1p20 / 64;

} // namespace

TEST_CASE("pixel_moments: means, covariances, biases and errors are those of the pixels") {
    const std::vector<std::vector<float>> filters{{1, -0.5f, 0.25f}, {0, 2, -1}};
    const drawn_pixels pixels(3, filters, 1);
    CHECK(pixel_moments(3, 2).empty());
    const pixel_moments seen = pixels.moments();
    CHECK(!seen.empty());
    const std::size_t count = pixels.inputs.size();
    const auto covariance = [&](const auto& a, const auto& b) {
        double of_a = 0, of_b = 0, product = 0;
        for (std::size_t p = 0; p < count; ++p)
            of_a += a(p) / static_cast<double>(count), of_b += b(p) / static_cast<double>(count);
        for (std::size_t p = 0; p < count; ++p)
            product += (a(p) - of_a) * (b(p) - of_b) / static_cast<double>(count);
        return product;
    };
    const auto input = [&](std::size_t tap) {
        return [&, tap](std::size_t p) { return static_cast<double>(pixels.inputs[p][tap]); };
    };
    const auto wanted = [&](std::size_t filter) {
        return [&, filter](std::size_t p) { return static_cast<double>(pixels.wanted[p][filter]); };
    };
    for (std::size_t t = 0; t < 3; ++t) {
        for (std::size_t u = 0; u < 3; ++u)
            CHECK(std::abs(seen.covariance(t, u) - covariance(input(t), input(u))) <= of_moments);
        for (std::size_t f = 0; f < 2; ++f)
            CHECK(std::abs(seen.covariance_with_wanted(f, t) - covariance(wanted(f), input(t))) <=
                  of_moments);
    }
    for (std::size_t f = 0; f < 2; ++f) {
        // All numbers are quarters and eighths: the exact weights leave the bias, and no error.
        CHECK(seen.best_bias(f, filters[f]) == 0.25);
        CHECK(std::abs(seen.error(f, filters[f], 0.25)) <= of_moments);
        for (const std::vector<float>& weights : {std::vector<float>{0, 0, 0}, {1, 1, 0}, {-2, 0.5f, 3}}) {
            const double bias = seen.best_bias(f, weights), least = seen.error(f, weights, bias);
            CHECK(std::abs(least - pixels.error(f, weights, bias)) <= of_moments);
            // Any bias other than the best one does worse, by the square of the distance.
            CHECK(std::abs(seen.error(f, weights, bias + 0.5) - least - 0.25) <= of_moments);
        }
    }
}

TEST_CASE(
    "filter_rounding: no move of one weight brings the sums nearer, and merely rounded ones are farther") {
    std::size_t moved = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        // In parts of a step, a quarter: rounded, all become smaller, and what is lost adds up.
        const std::vector<float> exact{-1.9375f / 4, -0.4375f / 4, 0.4375f / 4, 1.4375f / 4, 2.4375f / 4};
        const drawn_pixels pixels(5, {exact}, seed);
        const pixel_moments seen = pixels.moments();
        std::vector<float> rounded, fitted(5);
        for (const float weight : exact)
            rounded.push_back(std::nearbyint(weight * 4) / 4);
        filter_rounding(seen, 5).round(0, exact, 0.25f, fitted);
        const auto error = [&](std::span<const float> weights) {
            return pixels.error(0, weights, seen.best_bias(0, weights));
        };
        const double least = error(fitted);
        // The pull to exact weights may keep a move from being made that brings less than it costs: it is
        // a thousandth of the mean variance, times what the squares of two weights' distances differ by,
        // which is (d + 1)² − d² steps of a distance d below 3.
        double variance = 0;
        for (std::size_t t = 0; t < 5; ++t)
            variance += seen.covariance(t, t) / 5;
        const double pull = filter_rounding::ridge * variance * 7 * 0.25 * 0.25;
        CAPTURE(seed);
        CHECK(least <= error(rounded) + pull);
        moved += fitted != rounded;
        for (std::size_t t = 0; t < 5; ++t) {
            CHECK(fitted[t] * 4 == std::nearbyint(fitted[t] * 4));
            for (const float step : {-0.25f, 0.25f}) {
                std::vector<float> other = fitted;
                other[t] += step;
                CHECK(error(other) >= least - pull);
            }
        }
    }
    CHECK(moved > 30);
}

TEST_CASE("filter_rounding: weights have a place in a signed byte, and stay where inputs say nothing") {
    // One input that is always 2, so does not vary, and one that goes from 0 to 63.
    pixel_moments seen(2, 1);
    for (int pixel = 0; pixel < 64; ++pixel) {
        const std::array<std::pair<std::size_t, float>, 2> inputs{std::pair{std::size_t{0}, 2.0f},
                                                                  {1, static_cast<float>(pixel)}};
        const float wanted = 200 * static_cast<float>(pixel);
        seen.add(inputs, std::span(&wanted, 1));
    }
    std::array<float, 2> fitted{};
    const std::array<float, 2> exact{31.4f, 90};
    filter_rounding(seen, 2).round(0, exact, 1, fitted);
    CHECK(fitted[0] == 31); // only pulled to 31.4
    CHECK(fitted[1] == 127);
    filter_rounding(seen, 2).round(0, exact, 2, fitted);
    CHECK(fitted[1] == 200); // a hundred steps
    const std::array<float, 2> far{-500, 500};
    filter_rounding(seen, 2).round(0, far, 1, fitted);
    CHECK(fitted[0] == -127);
    // Of inputs that never vary nothing is known: all weights are merely rounded.
    pixel_moments constant(2, 1);
    const std::array<std::pair<std::size_t, float>, 1> same{std::pair{std::size_t{1}, 3.0f}};
    const float wanted = 7;
    for (int pixel = 0; pixel < 4; ++pixel)
        constant.add(same, std::span(&wanted, 1));
    filter_rounding(constant, 2).round(0, exact, 1, fitted);
    CHECK(fitted == std::array<float, 2>{31, 90});
}
