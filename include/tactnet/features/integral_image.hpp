#pragma once

#include <tactnet/tensor/tensor_view.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

// Sums over any upright rectangle in four reads (Viola and Jones, "Rapid object detection using a boosted
// cascade of simple features", 2001; Crow's summed-area table, 1984).

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What pixels are added up in: counts of 8 or 16 bits exactly, anything else in double.
template <class Pixel>
using integral_value = std::conditional_t<std::integral<Pixel> && sizeof(Pixel) <= 2, std::int32_t, double>;

/// The integral image of one map. Its corners lie between the pixels: that at (row, column) holds the sum of
/// all pixels above and to the left. Outside the image are zeros; `Border` corners on every side lie in
/// memory too, so that `row` needs no test for them.
template <class Pixel, shape Shape, std::size_t Border = 0>
class integral_image {
    static_assert(Shape.channels == 1 && Shape.area() > 0, "integral_image: expected one map with pixels");

public:
    using value_type = integral_value<Pixel>;
    // Four times as much room as the sum of all pixels, for what is then done with the sums.
    static_assert(std::floating_point<value_type> ||
                      Shape.area() <= (std::size_t{1} << (29 - 8 * std::min<std::size_t>(sizeof(Pixel), 2))),
                  "integral_image: the sums of this many whole numbers do not fit into 32 bits");

    /// Of another image, in the place of the last one.
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
    /// The sum of the absolute values of real pixels; 0 for whole numbers.
    [[nodiscard]] double magnitude() const noexcept { return magnitude_; }
    /// How far a corner may be from the exact sum: 0 for whole numbers. A pixel goes through at most as many
    /// roundings as there are rows and columns; twice that, for those of a box.
    [[nodiscard]] double rounding() const noexcept {
        return magnitude_ * static_cast<double>(Shape.rows + Shape.columns) *
               std::numeric_limits<double>::epsilon();
    }
    /// Whether no pixel is NaN or infinite: one that is would have spread into the last sum.
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

} // namespace TACTNET_ARCH
} // namespace tactnet
