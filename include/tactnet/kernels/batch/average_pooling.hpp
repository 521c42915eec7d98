#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <cstddef>

// Averages of windows. Which pixels a window holds is found when running: the loops over them are the same
// for any size, and are compiled once.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// The windows along rows or columns: a window that slides, or as many bins as there are outputs, as equal as
/// can be (kernel zero).
struct average_axis {
    std::size_t size, outputs;
    std::size_t kernel = 0, stride = 0, before = 0, after = 0;

    /// The pixels of window i. Bins as PyTorch's: from floor(i · size / outputs) to ceil((i + 1) · size /
    /// outputs); they may overlap.
    [[nodiscard]] constexpr pixel_range pixels(std::size_t i) const {
        if (kernel == 0)
            return {i * size / outputs, ((i + 1) * size + outputs - 1) / outputs};
        const std::size_t begin = i * stride;
        return {std::min(std::max(begin, before) - before, size),
                std::min(std::max(begin + kernel, before) - before, size)};
    }
    /// The pixels of window i, and the zeros around them.
    [[nodiscard]] constexpr std::size_t padded(std::size_t i) const {
        if (kernel == 0)
            return pixels(i).end - pixels(i).begin;
        return std::min(i * stride + kernel, size + before + after) - i * stride;
    }
    friend constexpr bool operator==(const average_axis&, const average_axis&) = default;
};

/// All windows of a layer. The divisor counts the pixels under a window, or the zeros around as well.
struct average_windows {
    average_axis rows, columns;
    bool counts_padding = false;

    [[nodiscard]] constexpr std::size_t divisor(std::size_t y, std::size_t x) const {
        const pixel_range r = rows.pixels(y), c = columns.pixels(x);
        return counts_padding ? rows.padded(y) * columns.padded(x) : (r.end - r.begin) * (c.end - c.begin);
    }
    /// body(output, rows, columns, divisor) for every output pixel.
    template <class Body>
    void for_each(Body&& body) const {
        for (std::size_t y = 0; y < rows.outputs; ++y)
            for (std::size_t x = 0; x < columns.outputs; ++x)
                body(y * columns.outputs + x, rows.pixels(y), columns.pixels(x), divisor(y, x));
    }
    friend constexpr bool operator==(const average_windows&, const average_windows&) = default;
};

/// output = the sum of each window ÷ its divisor.
template <class T>
void average_pool_forward(const average_windows& windows, std::size_t channels, const T* input, T* output) {
    constexpr std::size_t width = lanes<T>;
    const std::size_t columns_of_input = windows.columns.size;
    for (std::size_t channel = 0; channel < channels; ++channel) {
        windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
            vector<T> sum(T{});
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    sum = sum + load(input + (y * columns_of_input + x) * width);
            store(output + o * width, sum / vector<T>(static_cast<T>(divisor)));
        });
        input += windows.rows.size * windows.columns.size * width;
        output += windows.rows.outputs * windows.columns.outputs * width;
    }
}

/// input_gradient = each window's gradient ÷ its divisor, given to all of its pixels.
template <class T>
void average_pool_backward(const average_windows& windows, std::size_t channels, const T* output_gradient,
                           T* input_gradient) {
    constexpr std::size_t width = lanes<T>;
    const std::size_t columns_of_input = windows.columns.size,
                      plane = windows.rows.size * windows.columns.size * width;
    std::fill_n(input_gradient, channels * plane, T{});
    for (std::size_t channel = 0; channel < channels; ++channel) {
        windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
            const vector<T> share = load(output_gradient + o * width) / vector<T>(static_cast<T>(divisor));
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x) {
                    T* const to = input_gradient + (y * columns_of_input + x) * width;
                    store(to, load(to) + share);
                }
        });
        input_gradient += plane;
        output_gradient += windows.rows.outputs * windows.columns.outputs * width;
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
