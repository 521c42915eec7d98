// Clusters and descriptors of images that have nothing in them, of points that are all the same, or far away.

#include "hold.hpp"

#include <tactnet/features.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <features/images.hpp>
#include <memory>
#include <span>
#include <string>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;
using hard_cases::hold;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

constexpr double u = support::unit_roundoff<float>;
constexpr std::size_t values = 5;

/// Two clusters, `apart` from each other around `middle`, each a tenth as wide.
std::vector<float> two_clusters(std::size_t count, float middle, float apart) {
    random_stream random(3, random_purposes::order);
    std::vector<float> points(count * values);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = middle + (i / values % 2 == 0 ? apart : 0) +
                    apart / 10 * static_cast<float>(random.uniform(-1, 1));
    return points;
}
std::uint32_t nearest(const float* point, const float* centres, std::size_t count) {
    std::uint32_t best = 0;
    double least = INFINITY;
    for (std::uint32_t c = 0; c < count; ++c) {
        double distance = 0;
        for (std::size_t v = 0; v < values; ++v)
            distance +=
                std::pow(static_cast<double>(point[v]) - static_cast<double>(centres[c * values + v]), 2);
        if (distance < least)
            least = distance, best = c;
    }
    return best;
}

/// The clusters are ten times as far apart as they are wide: no rounding of their numbers makes another one
/// nearer.
void check_clusters(const std::string& name, float middle, float apart) {
    const std::vector<float> points = two_clusters(200, middle, apart);
    thread_pool threads(1);
    const k_means_result found = k_means<values>(points, {.centres = 2}, threads);
    REQUIRE(found.centres.size() == 2 * values);
    INFO(name);
    for (std::size_t i = 0; i < 200; ++i) {
        CHECK(found.nearest[i] == nearest(points.data() + i * values, found.centres.data(), 2));
        CHECK(found.nearest[i] == found.nearest[i % 2]);
    }
}

} // namespace

TEST_CASE("k_means: clusters far from zero, and of any size") {
    check_clusters("two clusters at 0, 1 apart", 0, 1);
    check_clusters("two clusters at 1e4, 1 apart", 1e4f, 1);
    check_clusters("two clusters at 1e6, 10 apart", 1e6f, 10);
    check_clusters("two clusters of 1e-18", 0, 1e-18f);
    check_clusters("two clusters of 1e16", 0, 1e16f);
}

TEST_CASE("k_means: points that are all the same, and more centres than points") {
    thread_pool threads(1);
    const std::vector<float> alike(100 * values, 0.1f);
    const k_means_result one = k_means<values>(alike, {.centres = 10}, threads);
    CHECK(one.centres.size() == values);
    CHECK(one.objective == 0);
    const std::vector<float> few = two_clusters(3, 0, 1);
    const k_means_result three = k_means<values>(few, {.centres = 50}, threads);
    CHECK(three.centres.size() == 3 * values);
    CHECK(three.objective == 0); // a mean of one number is that number
    // Two centres on one point: one is empty, and the mean of nothing is NaN.
    std::vector<float> twice(few.begin(), few.begin() + values);
    twice.insert(twice.end(), few.begin(), few.begin() + values);
    const k_means_result filled = k_means_from<values>(few, twice, {.centres = 2}, threads);
    CHECK(std::isfinite(filled.centres[values]));
}

// Each cluster is a word. Counts divided by their length: 100 ÷ √(2 · 100²), rounded four times.
TEST_CASE("bag_of_words: words far from zero, descriptors that are all the same, and none") {
    const auto histogram = [](const std::vector<float>& words, std::span<const float> descriptors) {
        std::array<float, 2> counts{};
        bag_of_words<values, 2>{words}.encode(descriptors, counts);
        return counts;
    };
    for (const float middle : {0.0f, 1e4f}) {
        const std::vector<float> points = two_clusters(200, middle, 1);
        std::vector<float> words(2 * values);
        for (std::size_t v = 0; v < values; ++v)
            words[v] = middle + 1, words[values + v] = middle;
        for (const float count : histogram(words, points))
            hold("a histogram", unit::absolute, {std::sqrt(0.5), static_cast<double>(count), 4 * u});
    }
    const std::vector<float> words = two_clusters(2, 0, 1), alike(100 * values, 1.0f);
    CHECK(histogram(words, alike)[0] == 1);
    CHECK(histogram(words, {}) == std::array{0.0f, 0.0f});
}

// Sums of real numbers that are no larger than their rounding count as zero: no descriptor inside.
TEST_CASE("dense_surf: constant images of counts and of real numbers") {
    constexpr shape size{28, 50, 1};
    tensor<float, size> image;
    std::fill(image.begin(), image.end(), 0.1f);
    const auto surf = std::make_unique<dense_surf<size, surf_grid{}, float>>();
    REQUIRE(surf->describe(image));
    bool finite = true;
    for (const float value : surf->descriptors())
        finite &= std::isfinite(value);
    CHECK(finite);
    for (const surf_place p : surf->places()) // none away from the border
        CHECK_FALSE(
            (p.level == 0 && p.row >= 10 && p.row + 11 <= 27 && p.column >= 10 && p.column + 11 <= 49));
    std::fill(image.begin(), image.end(), 0.0f);
    REQUIRE(surf->describe(image));
    CHECK(surf->places().empty());
}

namespace {

constexpr shape vast{3200, 3200, 1};

template <class Texture>
void check_vast(const std::string& name, Texture&& texture) {
    const auto image = std::make_unique<tensor<float, vast>>();
    for (std::size_t i = 0; i < vast.size(); ++i)
        (*image)(i / 3200, i % 3200) = texture(i);
    const auto integral = std::make_unique<integral_image<float, vast>>();
    integral->compute(*image);
    std::vector<outcome> all;
    for (std::size_t c = 3000; c < 3200; ++c) {
        const double exact = static_cast<double>((*image)(3199, c));
        all.push_back(
            {exact, integral->box(3199, static_cast<std::ptrdiff_t>(c), 1, 1), 4 * integral->rounding()});
    }
    hold(name + ": one pixel", unit::absolute, all);
    // A square of 64 × 64: many pixels of the texture, all of their offset.
    all.clear();
    for (std::size_t c = 3000; c + 64 <= 3200; c += 8) {
        long double exact = 0;
        for (std::size_t y = 3200 - 64; y < 3200; ++y)
            for (std::size_t x = c; x < c + 64; ++x)
                exact += (*image)(y, x);
        all.push_back({static_cast<double>(exact),
                       integral->box(3200 - 64, static_cast<std::ptrdiff_t>(c), 64, 64),
                       4 * integral->rounding()});
    }
    hold(name + ": a square of 64 × 64", unit::absolute, all);
}

} // namespace

// A corner is off by at most as many roundings of 2^-52 as there are rows and columns, of the sum of all
// pixels.
TEST_CASE("integral_image: ten million pixels of a large offset and a weak texture") {
    check_vast("integral image, 10⁷ pixels of 1000 ± 0.1",
               [](std::size_t i) { return 1000.0f + 0.002f * static_cast<float>(i * 37 % 101); });
    check_vast("integral image, 10⁷ pixels of 1 ± 1e-6",
               [](std::size_t i) { return 1.0f + 2e-8f * static_cast<float>(i * 37 % 101); });
}
