#include "images.hpp"

#include <tactnet/features/integral_image.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace tactnet;
using namespace features_test;

namespace {

template <std::size_t Scale, class Pixel, shape Shape>
void compare_responses() {
    const auto image = random_image<Pixel, Shape>(Scale);
    integral_image<Pixel, Shape, 2 * Scale> integral;
    integral.compute(image);
    constexpr auto s = static_cast<std::ptrdiff_t>(Scale);
    std::size_t wrong = 0, different = 0;
    for (std::ptrdiff_t r = -s; r <= static_cast<std::ptrdiff_t>(Shape.rows) + s; ++r)
        for (std::ptrdiff_t c = -s; c <= static_cast<std::ptrdiff_t>(Shape.columns) + s; ++c) {
            const auto [dx, dy] = haar_at<Scale>(integral, r, c);
            const double horizontal =
                             plain_sum(image, r - s, c, 2 * s, s) - plain_sum(image, r - s, c - s, 2 * s, s),
                         vertical =
                             plain_sum(image, r, c - s, s, 2 * s) - plain_sum(image, r - s, c - s, s, 2 * s);
            // The corners' errors, then as much again for what counts as zero.
            const double limit = 16 * integral.rounding();
            wrong += !(std::abs(static_cast<double>(dx) - horizontal) <= limit) ||
                     !(std::abs(static_cast<double>(dy) - vertical) <= limit);
            different += horizontal != vertical;
        }
    CHECK(wrong == 0);
    CHECK(different > Shape.area() / 2);
}

} // namespace

TEST_CASE("haar_at: the right half less the left, the lower less the upper, zeros outside") {
    compare_responses<1, std::uint8_t, shape{7, 9}>();
    compare_responses<2, std::uint8_t, shape{7, 9}>();
    compare_responses<3, std::uint8_t, shape{4, 5}>();
    compare_responses<1, float, shape{7, 9}>();
    compare_responses<3, float, shape{7, 9}>();
}

TEST_CASE("haar_at: signs") {
    tensor<std::uint8_t, shape{4, 4}> image;
    image(1, 2) = 10; // right of and above the middle
    integral_image<std::uint8_t, shape{4, 4}, 2> integral;
    integral.compute(image);
    CHECK(haar_at<2>(integral, 2, 2).dx == 10);
    CHECK(haar_at<2>(integral, 2, 2).dy == -10);
}

TEST_CASE("haar_at: a constant image of real numbers has no response but at its border") {
    tensor<double, shape{28, 50}> image;
    std::fill(image.begin(), image.end(), 0.1); // whose sums are rounded
    integral_image<double, shape{28, 50}, 4> integral;
    integral.compute(image);
    for (std::ptrdiff_t r = 2; r <= 26; ++r)
        for (std::ptrdiff_t c = 2; c <= 48; ++c) {
            CHECK(haar_at<2>(integral, r, c).dx == 0);
            CHECK(haar_at<2>(integral, r, c).dy == 0);
        }
    CHECK(haar_at<2>(integral, 14, 0).dx == doctest::Approx(0.8));
}
