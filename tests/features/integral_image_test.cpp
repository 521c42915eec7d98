#include "images.hpp"

#include <tactnet/features/integral_image.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>

using namespace tactnet;
using namespace features_test;

namespace {

template <class Pixel, shape Shape, std::size_t Border>
void compare_boxes() {
    const auto image = random_image<Pixel, Shape>(Shape.rows);
    integral_image<Pixel, Shape, Border> integral;
    integral.compute(image);
    constexpr auto rows = static_cast<std::ptrdiff_t>(Shape.rows),
                   columns = static_cast<std::ptrdiff_t>(Shape.columns),
                   border = static_cast<std::ptrdiff_t>(Border);
    std::size_t wrong = 0;
    for (std::ptrdiff_t r = -3; r <= rows + 2; ++r)
        for (std::ptrdiff_t c = -3; c <= columns + 2; ++c)
            for (std::ptrdiff_t height = 0; height <= rows + 2; ++height)
                for (std::ptrdiff_t width = 0; width <= columns + 2; ++width) {
                    const double error = std::abs(static_cast<double>(integral.box(r, c, height, width)) -
                                                  plain_sum(image, r, c, height, width));
                    wrong += !(error <= 4 * integral.rounding()); // four corners; 0 for whole numbers
                }
    CHECK(wrong == 0);
    for (std::ptrdiff_t r = -border; r <= rows + border; ++r)
        for (std::ptrdiff_t c = -border; c <= columns + border; ++c)
            wrong += integral.corner_row(r)[c] != integral(r, c);
    CHECK(wrong == 0);
}

} // namespace

TEST_CASE("integral_image: every rectangle, inside and outside, against plain sums") {
    compare_boxes<std::uint8_t, shape{7, 13}, 0>();
    compare_boxes<std::uint8_t, shape{7, 13}, 3>();
    compare_boxes<std::uint8_t, shape{1, 1}, 2>();
    compare_boxes<std::uint16_t, shape{5, 3}, 1>();
    compare_boxes<float, shape{7, 13}, 0>();
    compare_boxes<float, shape{4, 9}, 2>();
}

TEST_CASE("integral_image: a second image leaves nothing of the first") {
    constexpr shape size{5, 6};
    integral_image<float, size, 2> integral, fresh;
    auto broken = random_image<float, size>(1);
    broken(2, 3) = std::numeric_limits<float>::quiet_NaN();
    integral.compute(broken);
    CHECK(!integral.finite());
    const auto image = random_image<float, size>(2);
    integral.compute(image);
    fresh.compute(image);
    CHECK(integral.finite());
    for (std::ptrdiff_t r = -2; r <= 7; ++r)
        for (std::ptrdiff_t c = -2; c <= 8; ++c)
            CHECK(integral.corner_row(r)[c] == fresh.corner_row(r)[c]);
    CHECK(integral.rounding() == fresh.rounding());
}

TEST_CASE("integral_image: how large its pixels are, and what may be lost of them") {
    constexpr shape size{2, 3};
    tensor<float, size> image;
    const float pixels[] = {-1.0F, 2.5F, 0.0F, -4.0F, 8.0F, -0.5F};
    std::copy(std::begin(pixels), std::end(pixels), image.data());
    integral_image<float, size> integral;
    CHECK(integral.magnitude() == 0);
    integral.compute(image);
    CHECK(integral.magnitude() == 16);
    CHECK(integral.rounding() == 16 * 5 * std::numeric_limits<double>::epsilon());
    integral_image<std::uint8_t, size> whole;
    whole.compute(random_image<std::uint8_t, size>(3));
    CHECK(whole.magnitude() == 0);
}

TEST_CASE("integral_image: NaN and infinity anywhere are seen, also when they would cancel") {
    constexpr shape size{3, 4};
    for (std::size_t e = 0; e < size.area(); ++e) {
        integral_image<float, size> integral;
        tensor<float, size> image;
        image.data()[e] = std::numeric_limits<float>::infinity();
        integral.compute(image);
        CHECK(!integral.finite());
        image.data()[(e + 5) % size.area()] = -std::numeric_limits<float>::infinity();
        integral.compute(image);
        CHECK(!integral.finite());
    }
}

TEST_CASE("integral_image: the largest counts") {
    constexpr shape size{64, 1024};
    tensor<std::uint8_t, size> image;
    std::fill(image.begin(), image.end(), std::uint8_t{255});
    integral_image<std::uint8_t, size> integral;
    integral.compute(image);
    CHECK(integral.box(0, 0, 64, 1024) == 255 * 64 * 1024);
}

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

namespace {

/// Ten million pixels of a large offset and a weak texture. A corner is off by at most as many roundings of
/// 2^-52 as there are rows and columns, of the sum of all pixels.
void check_vast(float offset, float texture) {
    constexpr shape vast{3200, 3200, 1};
    const auto image = std::make_unique<tensor<float, vast>>();
    for (std::size_t i = 0; i < vast.size(); ++i)
        (*image)(i / 3200, i % 3200) = offset + texture * static_cast<float>(i * 37 % 101);
    const auto integral = std::make_unique<integral_image<float, vast>>();
    integral->compute(*image);
    for (std::size_t c = 3000; c < 3200; ++c)
        CHECK(std::abs(integral->box(3199, static_cast<std::ptrdiff_t>(c), 1, 1) -
                       static_cast<double>((*image)(3199, c))) <= 4 * integral->rounding());
    for (std::size_t c = 3000; c + 64 <= 3200; c += 8) {
        long double exact = 0;
        for (std::size_t y = 3200 - 64; y < 3200; ++y)
            for (std::size_t x = c; x < c + 64; ++x)
                exact += (*image)(y, x);
        CHECK(std::abs(integral->box(3200 - 64, static_cast<std::ptrdiff_t>(c), 64, 64) -
                       static_cast<double>(exact)) <= 4 * integral->rounding());
    }
}

} // namespace

TEST_CASE("integral_image: ten million pixels of a large offset and a weak texture") {
    check_vast(1000, 0.002f);
    check_vast(1, 2e-8f);
}
