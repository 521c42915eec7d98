#pragma once

#include <tactnet/image/resize_kernel.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

// Resize between sizes known only at run time, such as those of image files, in double precision.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The taps of all outputs of a size known at run time, in double precision.
template <class Kernel>
class dynamic_axis {
public:
    using output = detail::resize_taps<std::vector<double>>;

    dynamic_axis(std::size_t from, std::size_t to) : table_(to) {
        for (std::size_t o = 0; o < to; ++o) {
            table_[o].weights.resize(detail::max_taps(from, to));
            detail::find_taps<Kernel>(o, from, to, table_[o]);
        }
    }
    [[nodiscard]] const output& operator[](std::size_t index) const { return table_[index]; }
    [[nodiscard]] std::size_t size() const { return table_.size(); }

private:
    std::vector<output> table_;
};

namespace detail {

template <class Kernel, class Count>
[[nodiscard]] std::vector<double> resize_exactly(std::span<const Count> image, std::size_t rows,
                                                 std::size_t columns, std::size_t new_rows,
                                                 std::size_t new_columns) {
    if (rows == 0 || columns == 0 || new_rows == 0 || new_columns == 0 || image.size() / rows != columns ||
        image.size() % rows != 0)
        throw std::invalid_argument("resize_bicubic: expected non-empty images and rows × columns pixels");
    // Products of sizes below this do not wrap around.
    constexpr std::size_t max_pixels = std::numeric_limits<std::size_t>::max() / sizeof(double) / 64;
    if (new_columns > max_pixels / new_rows || columns > max_pixels / new_rows)
        throw std::length_error("resize_bicubic: expected an image that fits into memory");
    const dynamic_axis<Kernel> down(rows, new_rows), along(columns, new_columns);
    std::vector<double> middle(new_rows * columns), result(new_rows * new_columns);
    for (std::size_t y = 0; y < new_rows; ++y)
        down[y].for_each([&](std::size_t row, double weight) {
            for (std::size_t x = 0; x < columns; ++x)
                middle[y * columns + x] += weight * static_cast<double>(image[row * columns + x]);
        });
    for (std::size_t y = 0; y < new_rows; ++y)
        for (std::size_t x = 0; x < new_columns; ++x)
            along[x].for_each([&](std::size_t column, double weight) {
                result[y * new_columns + x] += weight * middle[y * columns + column];
            });
    return result;
}

} // namespace detail

/// Resizes a row-major 8-bit image, rounded and clamped to 0 … 255. `Kernel` is as in resize. Throws
/// std::invalid_argument if an image is empty or its size does not match the pixels, and std::length_error or
/// std::bad_alloc if the new one does not fit into memory.
template <class Kernel = keys_cubic<>>
[[nodiscard]] std::vector<std::uint8_t> resize_bicubic(std::span<const std::uint8_t> image, std::size_t rows,
                                                       std::size_t columns, std::size_t new_rows,
                                                       std::size_t new_columns) {
    const auto exact = detail::resize_exactly<Kernel>(image, rows, columns, new_rows, new_columns);
    std::vector<std::uint8_t> result(exact.size());
    std::transform(exact.begin(), exact.end(), result.begin(), [](double value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    });
    return result;
}
/// Resizes a row-major image of floats, without clamping.
template <class Kernel = keys_cubic<>>
[[nodiscard]] std::vector<float> resize_bicubic(std::span<const float> image, std::size_t rows,
                                                std::size_t columns, std::size_t new_rows,
                                                std::size_t new_columns) {
    const auto exact = detail::resize_exactly<Kernel>(image, rows, columns, new_rows, new_columns);
    return {exact.begin(), exact.end()};
}

}} // namespace tactnet
