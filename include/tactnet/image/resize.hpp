#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

// Bicubic resize of images whose size is known only when running, as the paper lowers its resolution: Keys'
// kernel with a = −½ ("Cubic convolution interpolation for digital image processing", 1981), pixel centres at
// halves, symmetric border, support widened by the scale when shrinking (antialiasing), weights normalised to
// one.

namespace tactnet::inline TACTNET_ARCH {

/// Keys' cubic with a = −½.
[[nodiscard]] constexpr double keys_cubic(double x) {
    const double t = x < 0 ? -x : x;
    if (t <= 1)
        return (1.5 * t - 2.5) * t * t + 1;
    if (t < 2)
        return ((-0.5 * t + 2.5) * t - 4) * t + 2;
    return 0;
}

namespace detail {

/// Inputs and weights of each output along one direction.
struct resize_taps {
    std::size_t taps;
    std::vector<std::size_t> index;
    std::vector<double> weight;

    resize_taps(std::size_t from, std::size_t to) {
        const double scale = static_cast<double>(to) / static_cast<double>(from),
                     narrow = std::min(scale, 1.0);
        const double support = 4 / narrow;
        taps = static_cast<std::size_t>(std::ceil(support)) + 2;
        for (std::size_t o = 0; o < to; ++o) {
            const double center = (static_cast<double>(o) + 0.5) / scale - 0.5;
            const auto first = static_cast<std::ptrdiff_t>(std::floor(center - support / 2));
            double sum = 0;
            for (std::size_t t = 0; t < taps; ++t) {
                const std::ptrdiff_t position = first + static_cast<std::ptrdiff_t>(t);
                const double w = keys_cubic(narrow * (center - static_cast<double>(position)));
                index.push_back(mirror(position, static_cast<std::ptrdiff_t>(from)));
                weight.push_back(w);
                sum += w;
            }
            for (std::size_t t = 0; t < taps; ++t)
                weight[o * taps + t] /= sum;
        }
    }
    /// … 2 1 0 | 0 1 2 … n−1 | n−1 …
    static std::size_t mirror(std::ptrdiff_t position, std::ptrdiff_t size) {
        const std::ptrdiff_t m = ((position % (2 * size)) + 2 * size) % (2 * size);
        return static_cast<std::size_t>(m < size ? m : 2 * size - 1 - m);
    }
};

} // namespace detail

/// Resizes a row-major 8-bit image; the result is rounded and kept within 0 … 255. Throws
/// std::invalid_argument for an empty image or a size that does not match the pixels.
[[nodiscard]] inline std::vector<std::uint8_t> resize_bicubic(std::span<const std::uint8_t> image,
                                                              std::size_t rows, std::size_t columns,
                                                              std::size_t new_rows, std::size_t new_columns) {
    if (rows == 0 || columns == 0 || new_rows == 0 || new_columns == 0 || image.size() != rows * columns)
        throw std::invalid_argument("resize_bicubic: expected non-empty images and rows × columns pixels");
    const detail::resize_taps vertical(rows, new_rows), horizontal(columns, new_columns);
    std::vector<double> narrowed(new_rows * columns);
    for (std::size_t y = 0; y < new_rows; ++y)
        for (std::size_t t = 0; t < vertical.taps; ++t) {
            const double w = vertical.weight[y * vertical.taps + t];
            const std::size_t from = vertical.index[y * vertical.taps + t] * columns;
            for (std::size_t x = 0; x < columns && w != 0; ++x)
                narrowed[y * columns + x] += w * image[from + x];
        }
    std::vector<std::uint8_t> result(new_rows * new_columns);
    for (std::size_t y = 0; y < new_rows; ++y)
        for (std::size_t x = 0; x < new_columns; ++x) {
            double sum = 0;
            for (std::size_t t = 0; t < horizontal.taps; ++t)
                sum += horizontal.weight[x * horizontal.taps + t] *
                       narrowed[y * columns + horizontal.index[x * horizontal.taps + t]];
            result[y * new_columns + x] = static_cast<std::uint8_t>(std::lround(std::clamp(sum, 0.0, 255.0)));
        }
    return result;
}

} // namespace tactnet
