#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

// The pixels that each window of a pool covers. Padding is left out: a window is cut to the image.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Rows, or columns, begin … end − 1 of an image.
struct pixel_range {
    std::size_t begin, end;
};

/// Calls body(output, rows, columns) for each output pixel of one channel, with the pixels of its window.
template <sliding_window W, class Body>
[[gnu::always_inline]] inline void for_each_window(Body&& body) {
    const auto range = [](std::size_t index, std::size_t kernel, std::size_t stride, std::size_t before,
                          std::size_t size) {
        const std::size_t begin = index * stride;
        return pixel_range{std::max(begin, before) - before, std::min(begin + kernel - before, size)};
    };
    for (std::size_t y = 0; y < W.output_rows(); ++y) {
        const pixel_range rows = range(y, W.kernel.rows, W.stride.rows, W.top, W.input.rows);
        for (std::size_t x = 0; x < W.output_columns(); ++x)
            body(y * W.output_columns() + x, rows,
                 range(x, W.kernel.columns, W.stride.columns, W.left, W.input.columns));
    }
}
/// Calls body(pixel) for each pixel of one window, row by row.
template <sliding_window W, class Body>
[[gnu::always_inline]] inline void for_each_pixel(pixel_range rows, pixel_range columns, Body&& body) {
    constexpr std::size_t area = W.kernel.area();
    if (area <= 9 && rows.end - rows.begin == W.kernel.rows &&
        columns.end - columns.begin == W.kernel.columns) {
        const std::size_t first = rows.begin * W.input.columns + columns.begin;
#pragma GCC unroll 64
        for (std::size_t k = 0; k < area; ++k)
            body(first + k / W.kernel.columns * W.input.columns + k % W.kernel.columns);
    } else {
        for (std::size_t y = rows.begin; y < rows.end; ++y)
            for (std::size_t x = columns.begin; x < columns.end; ++x)
                body(y * W.input.columns + x);
    }
}
/// Whether each pixel is in exactly one window.
[[nodiscard]] constexpr bool tiles_input(const sliding_window& w) {
    return w.stride == w.kernel && w.output_rows() * w.stride.rows >= w.input.rows + w.top &&
           w.output_columns() * w.stride.columns >= w.input.columns + w.left;
}

/// The windows of a pool along rows or columns: a sliding window or, if `kernel` is zero, one bin
/// per output, as equal in size as possible.
struct pooling_axis {
    std::size_t size, outputs;
    std::size_t kernel = 0, stride = 0, before = 0, after = 0;

    /// The pixels of window i. Bins are PyTorch's: from floor(i · size / outputs) to ceil((i + 1) · size /
    /// outputs); they may overlap.
    [[nodiscard]] constexpr pixel_range pixels(std::size_t i) const {
        if (kernel == 0)
            return {i * size / outputs, detail::ceil_div((i + 1) * size, outputs)};
        const std::size_t begin = i * stride;
        return {std::min(std::max(begin, before) - before, size),
                std::min(std::max(begin + kernel, before) - before, size)};
    }
    /// The number of pixels and zeros of padding in window i.
    [[nodiscard]] constexpr std::size_t padded(std::size_t i) const {
        if (kernel == 0)
            return pixels(i).end - pixels(i).begin;
        return std::min(i * stride + kernel, size + before + after) - i * stride;
    }
    friend constexpr bool operator==(const pooling_axis&, const pooling_axis&) = default;
};

/// All windows of a pool, or the bins of an adaptive one. The divisor of an average counts the pixels under a
/// window and, if `counts_padding`, the padding as well.
struct pooling_windows {
    pooling_axis rows, columns;
    bool counts_padding = false;

    [[nodiscard]] constexpr std::size_t divisor(std::size_t y, std::size_t x) const {
        const pixel_range r = rows.pixels(y), c = columns.pixels(x);
        return counts_padding ? rows.padded(y) * columns.padded(x) : (r.end - r.begin) * (c.end - c.begin);
    }
    /// Calls body(output, rows, columns, divisor) for each output pixel.
    template <class Body>
    void for_each(Body&& body) const {
        for (std::size_t y = 0; y < rows.outputs; ++y)
            for (std::size_t x = 0; x < columns.outputs; ++x)
                body(y * columns.outputs + x, rows.pixels(y), columns.pixels(x), divisor(y, x));
    }
    friend constexpr bool operator==(const pooling_windows&, const pooling_windows&) = default;
};

/// The windows of a pool, cut at the border of the map.
[[nodiscard]] constexpr pooling_windows windows_of(const sliding_window& w) {
    return {.rows = {w.input.rows, w.output_rows(), w.kernel.rows, w.stride.rows, w.top, w.bottom},
            .columns = {w.input.columns, w.output_columns(), w.kernel.columns, w.stride.columns, w.left,
                        w.right}};
}

}} // namespace tactnet
