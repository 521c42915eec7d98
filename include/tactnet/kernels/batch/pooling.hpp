#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

// Max pooling of one group of samples. Padding is never looked at: a window is cut to the image.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

struct pixel_range {
    std::size_t begin, end;
};
/// body(output, rows, columns) for every output pixel of one channel, with the image pixels of its window.
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
/// body(pixel) for every pixel of one window, row by row.
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
/// Whether every pixel is in exactly one window.
[[nodiscard]] constexpr bool tiles_input(const sliding_window& w) {
    return w.stride == w.kernel && w.output_rows() * w.stride.rows >= w.input.rows + w.top &&
           w.output_columns() * w.stride.columns >= w.input.columns + w.left;
}

/// output = the largest value of each window.
template <sliding_window W, class T>
void max_pool_forward(const T* input, T* output) {
    constexpr std::size_t width = lanes<T>;
    for (std::size_t channel = 0; channel < W.input.channels; ++channel) {
        const T* from = input + channel * W.input.area() * width;
        T* to = output + channel * W.output_rows() * W.output_columns() * width;
        for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            vector<T> largest = load(from + (rows.begin * W.input.columns + columns.begin) * width);
            for_each_pixel<W>(rows, columns, [&](std::size_t pixel) {
                largest = maximum_keeping_nan<T>(load(from + pixel * width), largest);
            });
            store(to + o * width, largest);
        });
    }
}

/// input_gradient = the output's gradient, given to the first largest value of each window.
template <sliding_window W, class T>
void max_pool_backward(const T* input, const T* output, const T* output_gradient, T* input_gradient) {
    constexpr std::size_t width = lanes<T>;
    const vector<T> zero(T{});
    for (std::size_t channel = 0; channel < W.input.channels; ++channel) {
        const T* from = input + channel * W.input.area() * width;
        T* to = input_gradient + channel * W.input.area() * width;
        const std::size_t first = channel * W.output_rows() * W.output_columns();
        if constexpr (!tiles_input(W))
            std::fill_n(to, W.input.area() * width, T{});
        for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            const vector<T> largest = load(output + (first + o) * width);
            vector<T> rest = load(output_gradient + (first + o) * width);
            for_each_pixel<W>(rows, columns, [&](std::size_t pixel) {
                const auto here = load(from + pixel * width) == largest;
                const vector<T> given = choose<T>(here, rest, zero);
                rest = choose<T>(here, zero, rest);
                T* place = to + pixel * width;
                store(place, tiles_input(W) ? given : load(place) + given);
            });
        });
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
