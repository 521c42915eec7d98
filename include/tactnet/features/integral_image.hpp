#pragma once

#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

// The sum over any upright rectangle from four values (Viola and Jones, "Rapid object detection using a
// boosted cascade of simple features", 2001; Crow's summed-area table, 1984), and Haar wavelets, which are
// such sums.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The type of sums of pixels: exact for integers of 8 or 16 bits, double for all others.
template <class Pixel>
using integral_value = std::conditional_t<std::integral<Pixel> && sizeof(Pixel) <= 2, std::int32_t, double>;

/// The integral image of one map. Its corners lie between the pixels: the corner at (row, column) holds the
/// sum of all pixels above and to the left. Outside the image are zeros. `Border` corners on every side are
/// stored too, so that `corner_row` needs no bounds check.
template <class Pixel, shape Shape, std::size_t Border = 0>
class integral_image {
    static_assert(Shape.channels == 1 && Shape.area() > 0, "integral_image: expected one map with pixels");

public:
    using value_type = integral_value<Pixel>;
    // Leaves room for four times the sum of all pixels, for differences of sums.
    static_assert(std::floating_point<value_type> ||
                      Shape.area() <= (std::size_t{1} << (29 - 8 * std::min<std::size_t>(sizeof(Pixel), 2))),
                  "integral_image: the sums of this many whole numbers do not fit into 32 bits");

    /// Computes the integral image of `image`, which replaces the last one.
    void compute(tensor_view<const Pixel, Shape> image) noexcept {
        magnitude_ = 0;
        for (std::size_t r = 0; r < Shape.rows; ++r) {
            const value_type* above = corners_.data() + (r + Border) * stride + Border;
            value_type* to = corners_.data() + (r + 1 + Border) * stride + Border;
            value_type sum{};
            for (std::size_t c = 0; c < Shape.columns; ++c) {
                const auto pixel = static_cast<value_type>(image(r, c));
                sum += pixel;
                to[c + 1] = above[c + 1] + sum;
                if constexpr (std::floating_point<value_type>)
                    magnitude_ += std::abs(pixel);
            }
            std::fill_n(to + Shape.columns + 1, Border, to[Shape.columns]);
        }
        const value_type* last = corners_.data() + (Shape.rows + Border) * stride;
        for (std::size_t b = 0; b < Border; ++b)
            std::copy_n(last, stride, corners_.data() + (Shape.rows + 1 + b + Border) * stride);
    }

    /// The sum of all pixels above and to the left of any corner, inside the image or not.
    [[nodiscard]] value_type operator()(std::ptrdiff_t row, std::ptrdiff_t column) const noexcept {
        return corner_row(std::clamp<std::ptrdiff_t>(
            row, 0, Shape.rows))[std::clamp<std::ptrdiff_t>(column, 0, Shape.columns)];
    }
    /// The sum over `rows` × `columns` pixels, of which (row, column) is the upper left one.
    [[nodiscard]] value_type box(std::ptrdiff_t row, std::ptrdiff_t column, std::ptrdiff_t rows,
                                 std::ptrdiff_t columns) const noexcept {
        return (*this)(row + rows, column + columns) - (*this)(row, column + columns) -
               (*this)(row + rows, column) + (*this)(row, column);
    }
    /// The corners of one row: element c, from −Border to columns + Border, is the corner at column c.
    [[nodiscard]] const value_type* corner_row(std::ptrdiff_t row) const noexcept {
        return corners_.data() + (row + border) * static_cast<std::ptrdiff_t>(stride) + border;
    }
    /// The sum of the absolute values of floating-point pixels; 0 for integers.
    [[nodiscard]] double magnitude() const noexcept { return magnitude_; }
    /// Bound on the rounding error of a corner: 0 for integers. A pixel is rounded at most once per row and
    /// per column; the bound is twice that, for the sums of a box.
    [[nodiscard]] double rounding() const noexcept {
        return magnitude_ * static_cast<double>(Shape.rows + Shape.columns) *
               std::numeric_limits<double>::epsilon();
    }
    /// Whether no pixel is NaN or infinite, which would have reached the last sum.
    [[nodiscard]] bool finite() const noexcept {
        if constexpr (std::floating_point<value_type>)
            return std::isfinite((*this)(Shape.rows, Shape.columns));
        else
            return true;
    }

private:
    static constexpr std::size_t stride = Shape.columns + 1 + 2 * Border;
    static constexpr auto border = static_cast<std::ptrdiff_t>(Border);

    std::array<value_type, (Shape.rows + 1 + 2 * Border) * stride> corners_{};
    double magnitude_ = 0;
};

/// Responses to a horizontal and a vertical Haar wavelet at one place.
template <class T>
struct haar_response {
    T dx, dy;
};

/// Computes the responses to wavelets of 2 Scale × 2 Scale pixels around the corner (row, column): the right
/// half minus the left one, the lower half minus the upper one. They are the gradients of SURF (Bay, Ess,
/// Tuytelaars and Van Gool, 2008, section 4.1). The corner may lie outside of the image by `Border` − Scale.
/// For floating-point pixels, sums within their rounding error become zero, so that a constant image has
/// none.
template <std::size_t Scale, class Pixel, shape Shape, std::size_t Border>
[[nodiscard]] inline auto haar_at(const integral_image<Pixel, Shape, Border>& integral, std::ptrdiff_t row,
                                  std::ptrdiff_t column) noexcept {
    using value = typename integral_image<Pixel, Shape, Border>::value_type;
    constexpr auto s = static_cast<std::ptrdiff_t>(Scale);
    const value* upper = integral.corner_row(row - s) + column;
    const value* middle = integral.corner_row(row) + column;
    const value* lower = integral.corner_row(row + s) + column;
    const value diagonal = lower[s] - upper[-s], other = upper[s] - lower[-s];
    haar_response<value> response{diagonal - other - 2 * (lower[0] - upper[0]),
                                  diagonal + other - 2 * (middle[s] - middle[-s])};
    if constexpr (std::floating_point<value>) {
        const double limit = 8 * integral.rounding(); // eight corners, those in the middle twice
        response.dx = std::abs(response.dx) > limit ? response.dx : 0;
        response.dy = std::abs(response.dy) > limit ? response.dy : 0;
    }
    return response;
}

}} // namespace tactnet
