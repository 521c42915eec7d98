#pragma once

#include <tactnet/kernels/vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

// Max pooling of one group of samples. Padding is never looked at: a window is cut to the image.

namespace tactnet::inline TACTNET_ARCH {

/// Calls body(output, rows, columns) for every output pixel of one channel, with the image pixels of its
/// window.
struct pixel_range {
    std::size_t begin, end;
};
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

/// output = the largest value of each window.
template <sliding_window W, class T>
void max_pool_forward(const T* input, T* output) {
    constexpr std::size_t width = lanes<T>;
    for (std::size_t channel = 0; channel < W.input.channels; ++channel) {
        const T* from = input + channel * W.input.area() * width;
        T* to = output + channel * W.output_rows() * W.output_columns() * width;
        for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            vector<T> largest = load(from + (rows.begin * W.input.columns + columns.begin) * width);
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    largest = maximum<T>(load(from + (y * W.input.columns + x) * width), largest);
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
        std::fill_n(to, W.input.area() * width, T{});
        for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            const vector<T> largest = load(output + (first + o) * width);
            vector<T> rest = load(output_gradient + (first + o) * width);
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x) {
                    const std::size_t i = (y * W.input.columns + x) * width;
                    const auto here = load(from + i) == largest;
                    store(to + i, load(to + i) + choose<T>(here, rest, zero));
                    rest = choose<T>(here, zero, rest);
                }
        });
    }
}

} // namespace tactnet
