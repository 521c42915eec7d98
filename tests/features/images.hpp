#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <cstddef>
#include <type_traits>

namespace features_test {

/// Counts from 0 to 255, or real numbers from −1 to 1.
template <class Pixel, tactnet::shape Shape>
tactnet::tensor<Pixel, Shape> random_image(std::uint32_t number) {
    tactnet::random_stream random(5, tactnet::random_purposes::order, number);
    tactnet::tensor<Pixel, Shape> image;
    for (Pixel& pixel : image)
        if constexpr (std::is_integral_v<Pixel>)
            pixel = static_cast<Pixel>(random.below(256));
        else
            pixel = static_cast<Pixel>(random.uniform(-1, 1));
    return image;
}

/// 0 outside of the image.
template <class Pixel, tactnet::shape Shape>
double pixel_at(const tactnet::tensor<Pixel, Shape>& image, std::ptrdiff_t row, std::ptrdiff_t column) {
    const bool inside = row >= 0 && row < static_cast<std::ptrdiff_t>(Shape.rows) && column >= 0 &&
                        column < static_cast<std::ptrdiff_t>(Shape.columns);
    return inside
               ? static_cast<double>(image(static_cast<std::size_t>(row), static_cast<std::size_t>(column)))
               : 0;
}

/// The sum over rows × columns pixels from (row, column) on, one by one.
template <class Pixel, tactnet::shape Shape>
double plain_sum(const tactnet::tensor<Pixel, Shape>& image, std::ptrdiff_t row, std::ptrdiff_t column,
                 std::ptrdiff_t rows, std::ptrdiff_t columns) {
    double sum = 0;
    for (std::ptrdiff_t r = row; r < row + rows; ++r)
        for (std::ptrdiff_t c = column; c < column + columns; ++c)
            sum += pixel_at(image, r, c);
    return sum;
}

} // namespace features_test
