// Images of one row, one column or one pixel, of extreme ratios; maps that
// collapse an image or blow it up. Resizing is done in double and rounded once.

#include "hold.hpp"

#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/dynamic_resize.hpp>
#include <tactnet/image/transform.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;
using hard_cases::hold;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

constexpr double u = support::unit_roundoff<float>;

/// A constant stays one: weights add up to 1 within a few units of double.
template <class Kernel>
void check_constant(const std::string& name, std::size_t rows, std::size_t columns, std::size_t new_rows,
                    std::size_t new_columns) {
    const float value = 200.3f;
    const std::vector<float> image(rows * columns, value);
    const auto resized =
        resize_bicubic<Kernel>(std::span<const float>(image), rows, columns, new_rows, new_columns);
    std::vector<outcome> all;
    for (const float pixel : resized)
        all.push_back({static_cast<double>(value), static_cast<double>(pixel), 0.5});
    hold(name, unit::ulp, all);
}

} // namespace

TEST_CASE("resize_bicubic: images of one line or one pixel, and ratios of a thousand") {
    check_constant<keys_cubic<>>("1 × 1000 to 7 × 13, constant", 1, 1000, 7, 13);
    check_constant<keys_cubic<>>("1000 × 1 to 7 × 13, constant", 1000, 1, 7, 13);
    check_constant<keys_cubic<>>("1 × 1 to 28 × 50, constant", 1, 1, 28, 50);
    check_constant<keys_cubic<>>("1 × 1000 to 1000 × 1, constant", 1, 1000, 1000, 1);
    check_constant<lagrange_cubic>("1 × 1 to 28 × 50, constant, Lagrange cubic", 1, 1, 28, 50);
    check_constant<lagrange_cubic>("3 × 2 to 28 × 50, constant, Lagrange cubic", 3, 2, 28, 50);
}

// Lagrange's cubic through four pixels is exact on cubics, border included: rounded once, of weights that add
// up to at most 6 in magnitude along each axis, 2^-50 of double each.
TEST_CASE("resize_bicubic: a cubic through the paper's interpolation") {
    const std::size_t from = 10, to = 37;
    std::vector<float> image(from);
    const auto cubic = [&](double x) { return ((x - 3) * x - 4) * x * 2 + 11; };
    for (std::size_t i = 0; i < from; ++i)
        image[i] = static_cast<float>(cubic(static_cast<double>(i)));
    const auto resized = resize_bicubic<lagrange_cubic>(std::span<const float>(image), 1, from, 1, to);
    std::vector<outcome> all;
    double largest = 0;
    for (const float v : image)
        largest = std::max(largest, std::abs(static_cast<double>(v)));
    for (std::size_t i = 0; i < to; ++i) {
        const double exact = cubic((static_cast<double>(i) + 0.5) * from / to - 0.5);
        all.push_back({exact, static_cast<double>(resized[i]), u * std::abs(exact) + 6 * 0x1p-50 * largest});
    }
    hold("a cubic polynomial, 10 to 37 pixels, Lagrange cubic", unit::absolute, all);
}

namespace {

constexpr shape size{7, 13, 1};

tensor<float, size> transformed(const image_transform& t) {
    tensor<float, size> from, to;
    for (std::size_t i = 0; i < size.size(); ++i)
        from(i / 13, i % 13) = static_cast<float>(i * 37 % 256);
    transform_image<size>(t, from, to);
    return to;
}

/// All pixels become the same.
void check_map(const std::string& name, const image_transform& t, double exact) {
    const tensor<float, size> to = transformed(t);
    INFO(name);
    for (const float pixel : to)
        CHECK(static_cast<double>(pixel) == exact);
}

} // namespace

// The middle of 7 × 13 is pixel (3, 6), whose count is 45 · 37 mod 256. Outside of the image there is no
// contact.
TEST_CASE("transform_image: maps that collapse the image or blow it up") {
    const double middle = 45 * 37 % 256;
    check_map("an affine map of zeros: the centre pixel everywhere",
              {.row_by_row = 0, .row_by_column = 0, .column_by_row = 0, .column_by_column = 0}, middle);
    check_map("an affine map to 1e30: zeros", {.row_by_row = 0, .row_shift = 1e30, .column_by_column = 0}, 0);
    check_map("an affine map to −∞: zeros", {.row_by_row = 0, .row_shift = -INFINITY, .column_by_column = 0},
              0);
    check_map("an affine map to 1e300: zeros",
              {.row_by_row = 0, .column_by_column = 0, .column_shift = 1e300}, 0);
    check_map("a gain of 0", {.gain = 0}, 0);
    // All but the middle comes from 1e20 tactels away.
    const tensor<float, size> to = transformed(image_transform::of({.zoom = 1e-20}));
    for (std::size_t i = 0; i < size.size(); ++i)
        CHECK(static_cast<double>(to(i / 13, i % 13)) == (i == 45 ? middle : 0));
}
