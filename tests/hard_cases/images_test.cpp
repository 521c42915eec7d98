// Images of one row, one column or one pixel, of extreme ratios; the gain of interpolation at the border;
// maps that collapse an image or blow it up. Resizing is done in double and rounded once.

#include "record.hpp"

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
using hard_cases::limit;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

constexpr double u = support::unit_roundoff<float>;

/// Keys' cubic, a = −½, straight from its paper, in single precision; taps beyond the border take the nearest
/// pixel.
float plain_keys(float x) {
    x = std::abs(x);
    return x < 1 ? (1.5f * x - 2.5f) * x * x + 1 : x < 2 ? ((-0.5f * x + 2.5f) * x - 4) * x + 2 : 0.0f;
}
float plain_resized(const std::vector<float>& line, std::size_t inputs, std::size_t outputs, std::size_t at) {
    const float centre =
        (static_cast<float>(at) + 0.5f) * static_cast<float>(inputs) / static_cast<float>(outputs) - 0.5f;
    float sum = 0;
    for (int tap = -1; tap <= 2; ++tap) {
        const int place = static_cast<int>(std::floor(centre)) + tap;
        sum += plain_keys(centre - static_cast<float>(place)) *
               line[static_cast<std::size_t>(std::clamp(place, 0, static_cast<int>(inputs) - 1))];
    }
    return sum;
}

/// A constant stays one: weights add up to 1 within a few units of double.
template <class Kernel>
void check_constant(const std::string& name, std::size_t rows, std::size_t columns, std::size_t new_rows,
                    std::size_t new_columns) {
    const float value = 200.3f;
    const std::vector<float> image(rows * columns, value);
    const auto resized =
        resize_bicubic<Kernel>(std::span<const float>(image), rows, columns, new_rows, new_columns);
    std::vector<outcome> all;
    for (std::size_t i = 0; i < resized.size(); ++i)
        all.push_back({static_cast<double>(value),
                       static_cast<double>(plain_resized(image, columns, new_columns, i % new_columns)),
                       static_cast<double>(resized[i]), 0.5});
    hold("images", name, unit::ulp, all);
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
        all.push_back({exact, static_cast<double>(plain_resized(image, from, to, i)),
                       static_cast<double>(resized[i]), u * std::abs(exact) + 6 * 0x1p-50 * largest});
    }
    hold("images", "a cubic polynomial, 10 to 37 pixels, Lagrange cubic", unit::absolute, all);
}

// The sum of the magnitudes of all weights: what alternating noise of one count can become.
TEST_CASE("resize_bicubic: the gain at the border") {
    const auto gain = [](auto kernel, std::size_t from, std::size_t to) {
        std::vector<double> sums(to);
        for (std::size_t i = 0; i < from; ++i) {
            std::vector<float> impulse(from);
            impulse[i] = 1;
            const auto response =
                resize_bicubic<decltype(kernel)>(std::span<const float>(impulse), 1, from, 1, to);
            for (std::size_t o = 0; o < to; ++o)
                sums[o] += std::abs(static_cast<double>(response[o]));
        }
        return *std::ranges::max_element(sums);
    };
    limit("images", "noise gain of the Lagrange cubic along an axis, 4 to 400 pixels",
          gain(keys_cubic<>{}, 4, 400), gain(lagrange_cubic{}, 4, 400),
          "it extrapolates at the border; naive column: Keys' cubic");
    limit("images", "noise gain of the Lagrange cubic along an axis, 28 to 14 pixels",
          gain(keys_cubic<>{}, 28, 14), gain(lagrange_cubic{}, 28, 14),
          "as for the published resolutions; naive column: Keys' cubic");
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

/// Between four pixels in single precision, nothing outside; each weight times its pixel, wherever that is.
float plain_sampled(const image_transform& t, std::size_t i) {
    const auto y = static_cast<float>(i / 13) - 3, x = static_cast<float>(i % 13) - 6;
    const auto number = [](double value) { return static_cast<float>(value); };
    const float row = number(t.row_by_row) * y + number(t.row_by_column) * x + number(t.row_shift) + 3,
                column =
                    number(t.column_by_row) * y + number(t.column_by_column) * x + number(t.column_shift) + 6;
    float sum = 0;
    for (const float r : {std::floor(row), std::floor(row) + 1})
        for (const float c : {std::floor(column), std::floor(column) + 1}) {
            const bool inside = r >= 0 && r < 7 && c >= 0 && c < 13;
            const float pixel = inside ? static_cast<float>(static_cast<int>(r * 13 + c) * 37 % 256) : 0;
            sum += (1 - std::abs(row - r)) * (1 - std::abs(column - c)) * pixel;
        }
    return sum * number(t.gain);
}

/// All pixels become the same.
void check_map(const std::string& name, const image_transform& t, double exact) {
    const tensor<float, size> to = transformed(t);
    std::vector<outcome> all;
    for (std::size_t i = 0; i < size.size(); ++i)
        all.push_back(
            {exact, static_cast<double>(plain_sampled(t, i)), static_cast<double>(to(i / 13, i % 13)), 0});
    hold("images", name, unit::absolute, all);
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
    const image_transform thin = image_transform::of({.zoom = 1e-20});
    const tensor<float, size> to = transformed(thin);
    std::vector<outcome> all;
    for (std::size_t i = 0; i < size.size(); ++i)
        all.push_back({i == 45 ? middle : 0, static_cast<double>(plain_sampled(thin, i)),
                       static_cast<double>(to(i / 13, i % 13)), 0});
    hold("images", "a zoom of 1e-20: the centre pixel, and zeros", unit::absolute, all);
}
