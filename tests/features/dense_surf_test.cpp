#include "images.hpp"

#include <tactnet/features/dense_surf.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <support/allocations.hpp>
#include <support/tolerance.hpp>
#include <utility>
#include <vector>

using namespace tactnet;
using namespace features_test;

namespace {

constexpr shape size{28, 50};
template <class Pixel>
using image_of = tensor<Pixel, size>;

/// Value by value as the paper says, in double. Each with the sum of the magnitudes that it was added up
/// from.
struct plain_descriptor {
    std::array<double, surf_values> values{}, magnitudes{};
    double length = 0;
};

/// `row` and `column`: the tactel that the window lies around.
template <class Pixel, shape Shape>
plain_descriptor describe_plainly(const tensor<Pixel, Shape>& image, std::size_t row, std::size_t column,
                                  std::ptrdiff_t s) {
    plain_descriptor d;
    // The middle of the tactel, or its corner for even scales.
    const double middle = s % 2 == 1 ? 0.5 : 0, y0 = static_cast<double>(row) + middle,
                 x0 = static_cast<double>(column) + middle;
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j) {
            const double v = (i - 9.5) * static_cast<double>(s), u = (j - 9.5) * static_cast<double>(s),
                         sigma = 3.3 * static_cast<double>(s),
                         weight = std::exp(-(u * u + v * v) / (2 * sigma * sigma));
            const auto y = static_cast<std::ptrdiff_t>(std::lround(y0 + v)),
                       x = static_cast<std::ptrdiff_t>(std::lround(x0 + u));
            const double left = plain_sum(image, y - s, x - s, 2 * s, s),
                         right = plain_sum(image, y - s, x, 2 * s, s),
                         upper = plain_sum(image, y - s, x - s, s, 2 * s),
                         lower = plain_sum(image, y, x - s, s, 2 * s);
            const double dx = weight * (right - left), dy = weight * (lower - upper);
            const auto part = static_cast<std::size_t>(i / 5 * 4 + j / 5) * 4;
            const std::array<double, 4> terms{dx, std::abs(dx), dy, std::abs(dy)};
            for (std::size_t t = 0; t < 4; ++t) {
                d.values[part + t] += terms[t];
                d.magnitudes[part + t] += std::abs(terms[t]);
            }
        }
    d.length = std::sqrt(std::inner_product(d.values.begin(), d.values.end(), d.values.begin(), 0.0));
    return d;
}

/// Compares every descriptor of an image. `pixel_error`: of a Haar response, as a share of the image's
/// magnitude.
template <shape Shape, surf_grid Grid, class Pixel>
void compare(const tensor<Pixel, Shape>& image) {
    using surf = dense_surf<Shape, Grid, Pixel>;
    surf descriptors;
    REQUIRE(descriptors.describe(image));
    REQUIRE(descriptors.descriptors().size() == descriptors.places().size() * surf_values);
    // Each of 10 terms and two weights is rounded; so are the response and its scale.
    const double u = support::unit_roundoff<float>, sums = support::accumulated(u, 14),
                 length_error = std::sqrt(2.0) * sums + support::accumulated(u, 68) / 2;
    std::size_t found = 0, wrong = 0, empty = 0;
    for (std::size_t level = 0; level < Grid.levels(); ++level)
        for (std::size_t r = 0; r < surf::rows.count; ++r)
            for (std::size_t c = 0; c < surf::columns.count; ++c) {
                const plain_descriptor expected = describe_plainly(
                    image, surf::rows.first + r * Grid.step.rows, surf::columns.first + c * Grid.step.columns,
                    static_cast<std::ptrdiff_t>(Grid.scales[level]));
                if (expected.length == 0) {
                    ++empty;
                    continue;
                }
                REQUIRE(found < descriptors.places().size());
                const surf_place place = descriptors.places()[found];
                CHECK(place.level == level);
                CHECK(place.row == r);
                CHECK(place.column == c);
                for (std::size_t v = 0; v < surf_values; ++v) {
                    const double value = expected.values[v] / expected.length;
                    const double bound = sums * expected.magnitudes[v] / expected.length +
                                         (length_error + 3 * u) * std::abs(value);
                    wrong +=
                        !(std::abs(static_cast<double>(descriptors.descriptors()[found * surf_values + v]) -
                                   value) <= bound);
                }
                ++found;
            }
    CHECK(found == descriptors.places().size());
    CHECK(found + empty == surf::most);
    CHECK(wrong == 0);
}

/// The image with f of every count.
template <class Function>
image_of<std::uint8_t> changed(const image_of<std::uint8_t>& before, Function f) {
    image_of<std::uint8_t> image = before;
    for (std::uint8_t& pixel : image)
        pixel = static_cast<std::uint8_t>(f(pixel));
    return image;
}

template <class Pixel>
image_of<Pixel> with_blob(std::size_t top, std::size_t left) {
    image_of<Pixel> image;
    const auto blob = random_image<std::uint8_t, shape{9, 11}>(3);
    for (std::size_t r = 0; r < 9; ++r)
        for (std::size_t c = 0; c < 11; ++c)
            image(top + r, left + c) = static_cast<Pixel>(blob(r, c));
    return image;
}

} // namespace

TEST_CASE("dense_surf: against the paper's formulas in double, all scales, borders included") {
    compare<size, surf_grid{}>(random_image<std::uint8_t, size>(1));
    compare<size, surf_grid{.step = 5, .scales = {1, 2, 3, 4}}>(random_image<std::uint8_t, size>(2));
    compare<size, surf_grid{.step = {4, 7}, .scales = {3}}>(random_image<std::uint8_t, size>(3));
    compare<shape{7, 13}, surf_grid{.step = 1, .scales = {2, 1}}>(
        random_image<std::uint8_t, shape{7, 13}>(4));
    compare<shape{2, 2}, surf_grid{}>(random_image<std::uint8_t, shape{2, 2}>(5));
    compare<shape{30, 3}, surf_grid{}>(random_image<std::uint8_t, shape{30, 3}>(6));
    compare<size, surf_grid{}>(random_image<float, size>(7));
    compare<size, surf_grid{}>(with_blob<std::uint8_t>(4, 6));
}

TEST_CASE("dense_surf: the grid lies in the middle") {
    using surf = dense_surf<size>;
    CHECK(surf::rows.count == 10);
    CHECK(surf::rows.first == 0);
    CHECK(surf::columns.count == 17);
    CHECK(surf::columns.first == 0);
    CHECK(surf::most == 340);
    using coarse = dense_surf<shape{6, 8}, surf_grid{.step = 4}>;
    CHECK(coarse::rows.first == 0); // 0 and 4 of 0 … 5
    CHECK(coarse::columns.count == 2);
    CHECK(coarse::columns.first == 1); // 1 and 5 of 0 … 7
}

TEST_CASE("dense_surf: as many counts more everywhere change nothing where no window reaches the border") {
    const auto image = changed(random_image<std::uint8_t, size>(8), [](int count) { return count / 2; });
    const auto brighter = changed(image, [](int count) { return count + 100; });
    dense_surf<size, surf_grid{.step = 1, .scales = {1}}> a, b;
    REQUIRE(a.describe(image));
    REQUIRE(b.describe(brighter));
    std::size_t inside = 0, outside = 0;
    for (std::size_t i = 0; i < a.places().size(); ++i) {
        const surf_place p = a.places()[i];
        // The outermost wavelets reach 10 tactels up and left, and 11 down and right.
        const bool whole = p.row >= 10 && p.row + 11 <= 27 && p.column >= 10 && p.column + 11 <= 49;
        const auto of = [&](const auto& surf) {
            return surf.descriptors().subspan(i * surf_values, surf_values);
        };
        const bool equal = std::equal(of(a).begin(), of(a).end(), of(b).begin());
        CHECK((equal || !whole));
        inside += whole;
        outside += !equal;
    }
    CHECK(inside == 7 * 29);
    CHECK(outside > 0);
}

TEST_CASE("dense_surf: counts times a number change nothing") {
    const auto image = changed(random_image<std::uint8_t, size>(9), [](int count) { return count / 4; });
    const auto stronger = changed(image, [](int count) { return count * 4; });
    dense_surf<size> a, b;
    REQUIRE(a.describe(image));
    REQUIRE(b.describe(stronger));
    CHECK(std::equal(a.descriptors().begin(), a.descriptors().end(), b.descriptors().begin(),
                     b.descriptors().end())); // a power of two: to the bit
}

TEST_CASE("dense_surf: an image shifted by the grid's step has its descriptors shifted") {
    dense_surf<size> a, b;
    REQUIRE(a.describe(with_blob<std::uint8_t>(8, 12)));
    REQUIRE(b.describe(with_blob<std::uint8_t>(11, 18)));
    std::size_t compared = 0;
    for (std::size_t i = 0; i < a.places().size(); ++i)
        for (std::size_t j = 0; j < b.places().size(); ++j) {
            const surf_place p = a.places()[i], q = b.places()[j];
            if (p.level != q.level || p.row + 1 != q.row || p.column + 2 != q.column)
                continue;
            ++compared;
            CHECK(std::equal(a.descriptors().begin() + static_cast<std::ptrdiff_t>(i * surf_values),
                             a.descriptors().begin() + static_cast<std::ptrdiff_t>((i + 1) * surf_values),
                             b.descriptors().begin() + static_cast<std::ptrdiff_t>(j * surf_values)));
        }
    CHECK(compared > 100);
}

TEST_CASE("dense_surf: nothing to describe, broken numbers, very large and very small ones") {
    dense_surf<size> counts;
    CHECK(counts.describe(image_of<std::uint8_t>{}));
    CHECK(counts.places().empty());
    CHECK(counts.descriptors().empty());

    dense_surf<size, surf_grid{}, float> real;
    auto image = random_image<float, size>(10);
    REQUIRE(real.describe(image));
    const std::vector<float> expected(real.descriptors().begin(), real.descriptors().end());
    for (const float factor : {0x1p100f, 0x1p-100f}) {
        auto scaled = image;
        for (float& pixel : scaled)
            pixel *= factor;
        REQUIRE(real.describe(scaled));
        CHECK(std::equal(expected.begin(), expected.end(), real.descriptors().begin(),
                         real.descriptors().end()));
    }
    image(27, 49) = std::numeric_limits<float>::quiet_NaN();
    CHECK(!real.describe(image));
    CHECK(real.descriptors().empty());
    CHECK(real.describe(image_of<float>{}));
    CHECK(real.descriptors().empty());
}

TEST_CASE("dense_surf: constant real numbers are described at the border alone") {
    image_of<double> image;
    std::fill(image.begin(), image.end(), 0.1); // whose sums are rounded
    dense_surf<size, surf_grid{.step = 1, .scales = {1}}, double> surf;
    REQUIRE(surf.describe(image));
    CHECK(surf.places().size() > 0);
    for (const surf_place p : surf.places())
        CHECK(!(p.row >= 10 && p.row + 11 <= 27 && p.column >= 10 && p.column + 11 <= 49));
}

TEST_CASE("dense_surf: no heap in a call, and the same bits when called again") {
    dense_surf<size> surf;
    const auto image = random_image<std::uint8_t, size>(11), other = with_blob<std::uint8_t>(2, 30);
    REQUIRE(surf.describe(image));
    const std::vector<float> first(surf.descriptors().begin(), surf.descriptors().end());
    REQUIRE(surf.describe(other));
    const std::size_t before = support::allocations();
    const bool finite = surf.describe(image);
    CHECK(support::allocations() == before);
    CHECK(finite);
    CHECK(std::equal(first.begin(), first.end(), surf.descriptors().begin(), surf.descriptors().end()));
}
