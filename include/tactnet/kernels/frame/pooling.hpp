#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/pooling_windows.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

// Pooling of one frame that lies pixel by pixel, of floats or bytes: maximum over windows that overlap, which
// a convolution cannot fuse; averages of floats.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The largest of the pixels at(row, column), row by row. Several chains do not wait for each other.
template <std::size_t Chains, class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector largest_of(pixel_range rows, pixel_range columns,
                                                              const auto& at) {
    using pixels = pixel_access<Vector>;
    std::array<Vector, Chains> largest;
#pragma GCC unroll 4
    for (std::size_t i = 0; i < Chains; ++i)
        largest[i] = at(rows.begin, columns.begin);
    for (std::size_t y = rows.begin; y < rows.end; ++y) {
        std::size_t x = columns.begin;
        for (; x + Chains <= columns.end; x += Chains)
#pragma GCC unroll 4
            for (std::size_t i = 0; i < Chains; ++i)
                largest[i] = pixels::larger(at(y, x + i), largest[i]);
        for (; x < columns.end; ++x)
            largest[0] = pixels::larger(at(y, x), largest[0]);
    }
    for (std::size_t i = 1; i < Chains; ++i)
        largest[0] = pixels::larger(largest[i], largest[0]);
    return largest[0];
}

/// The vectors of channels that reduce_frame keeps side by side for each column, so that it reads memory in
/// longer pieces: as many as fill the registers.
[[nodiscard]] constexpr std::size_t vectors_together(std::size_t vectors, std::size_t columns) {
    std::size_t together = 4;
    while (together > 1 && (vectors % together != 0 || together * columns > max_block_sums))
        together /= 2;
    return together;
}

/// Reduces the columns of each window, then the window: a column that several windows share is reduced once.
/// `Stride` elements from one pixel to the next, in both maps; finish(value, divisor) is
/// stored.
template <pooling_windows Windows, std::size_t Stride, class Vector, class T>
[[gnu::flatten]] void reduce_frame(const T* input, T* output, const auto& combine, const auto& finish) {
    using pixels = pixel_access<Vector>;
    constexpr std::size_t width = sizeof(Vector) / sizeof(T), kernel_rows = Windows.rows.kernel,
                          kernel = Windows.columns.kernel, stride = Windows.columns.stride,
                          size = Windows.columns.size, outputs = Windows.columns.outputs,
                          before = Windows.columns.before;
    // Windows first … end − 1 of a row are not cut at the left or the right.
    constexpr std::size_t first = std::min(ceil_div(before, stride), outputs),
                          whole = size + before < kernel ? 0 : (size + before - kernel) / stride + 1,
                          end = std::clamp(whole, first, outputs);
    constexpr std::size_t together = vectors_together(Stride / width, kernel);
    // Processors without vectors need short code more.
    constexpr bool unrolls_rows = lanes<float> != 1;
    using block = std::array<Vector, together>;
    const auto load = [](const T* from) __attribute__((always_inline)) {
        block value;
#pragma GCC unroll 4
        for (std::size_t v = 0; v < together; ++v)
            value[v] = pixels::load(from + v * width);
        return value;
    };
    const auto add = [&](block & value, const block& other) __attribute__((always_inline)) {
#pragma GCC unroll 4
        for (std::size_t v = 0; v < together; ++v)
            value[v] = combine(other[v], value[v]);
    };
    const auto reduce_row = [&](std::size_t y, auto row_count, const T* from, T* to) {
        const auto column = [&](std::size_t x) {
            block value = load(from + x * Stride);
            for (std::size_t row = 1; row < row_count; ++row)
                add(value, load(from + (row * size + x) * Stride));
            return value;
        };
        const auto put = [&](std::size_t x, const block& value, std::size_t divisor) {
#pragma GCC unroll 4
            for (std::size_t v = 0; v < together; ++v)
                pixels::store(to + x * Stride + v * width, finish(value[v], divisor));
        };
        const auto reduce_cut = [&](std::size_t x) {
            const pixel_range columns = Windows.columns.pixels(x);
            block value = column(columns.begin);
            for (std::size_t c = columns.begin + 1; c < columns.end; ++c)
                add(value, column(c));
            put(x, value, Windows.divisor(y, x));
        };
        for (std::size_t x = 0; x != first; ++x)
            reduce_cut(x);
        if constexpr (first < end) {
            const std::size_t divisor = Windows.divisor(y, first);
            std::array<block, kernel> columns;
#pragma GCC unroll 8
            for (std::size_t c = 0; c + stride < kernel; ++c) // what the next window shares with this one
                columns[stride + c] = column(first * stride - before + c);
            for (std::size_t x = first; x < end; ++x) {
#pragma GCC unroll 8
                for (std::size_t c = 0; c < kernel; ++c)
                    columns[c] = c + stride < kernel ? columns[stride + c] : column(x * stride - before + c);
                block value = columns[0];
#pragma GCC unroll 8
                for (std::size_t c = 1; c < kernel; ++c)
                    add(value, columns[c]);
                put(x, value, divisor);
            }
        }
        for (std::size_t x = end; x < outputs; ++x)
            reduce_cut(x);
    };
    for (std::size_t y = 0; y < Windows.rows.outputs; ++y) {
        const pixel_range rows = Windows.rows.pixels(y);
        for (std::size_t channel = 0; channel < Stride; channel += together * width) {
            const T* const from = input + rows.begin * size * Stride + channel;
            T* const to = output + y * outputs * Stride + channel;
            if (unrolls_rows && rows.end - rows.begin == kernel_rows)
                reduce_row(y, std::integral_constant<std::size_t, kernel_rows>{}, from, to);
            else
                reduce_row(y, rows.end - rows.begin, from, to);
        }
    }
}

/// Whether reduce_frame keeps the columns of a window in registers.
[[nodiscard]] constexpr bool reduces_columns(const pooling_windows& windows) {
    constexpr std::size_t most = 8;
    return windows.rows.kernel > 0 && windows.columns.kernel > 0 && windows.rows.kernel <= most &&
           windows.columns.kernel <= most;
}

/// `Vector` divides `stride`: one instantiation for each.
template <class Vector, class T>
void largest_pixels(const pooling_windows& bins, std::size_t stride, const T* input, T* output) {
    using pixels = pixel_access<Vector>;
    bins.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t) {
        for (std::size_t channel = 0; channel < stride; channel += sizeof(Vector) / sizeof(T)) {
            const auto at = [&](std::size_t y, std::size_t x) {
                return pixels::load(input + (y * bins.columns.size + x) * stride + channel);
            };
            pixels::store(output + o * stride + channel, largest_of<4, Vector>(rows, columns, at));
        }
    });
}

/// output = the largest value of each bin. `Stride` elements from one pixel to the next, in both maps.
template <std::size_t Stride, class T>
void pool_frame(const pooling_windows& bins, const T* input, T* output) {
    largest_pixels<typename decltype(pixel_vector<T, Stride>())::type>(bins, Stride, input, output);
}
/// output = the largest value of each window. Inputs are finite: a NaN may be lost.
template <sliding_window W, std::size_t Stride, class T>
void pool_frame(const T* input, T* output) {
    using wide = typename decltype(pixel_vector<T, Stride>())::type;
    constexpr pooling_windows windows = windows_of(W);
    if constexpr (reduces_columns(windows))
        reduce_frame<windows, Stride, wide>(
            input, output, [](const wide& a, const wide& b) { return pixel_access<wide>::larger(a, b); },
            [](const wide& value, std::size_t) { return value; });
    else
        largest_pixels<wide>(windows, Stride, input, output);
}

/// `Vector` divides `stride`: one instantiation for each. Sums of several vectors side by side do not wait
/// for one another.
template <class Vector>
void average_pixels(const pooling_windows& windows, std::size_t stride, const float* input, float* output) {
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    using access = pixel_access<Vector>;
    windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
        const Vector count(static_cast<float>(divisor));
        const auto average = [&]<std::size_t Together>(std::integral_constant<std::size_t, Together>,
                                                       std::size_t channel) {
            Vector sums[Together];
            for (std::size_t i = 0; i < Together; ++i)
                sums[i] = Vector(0.0f);
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x) {
                    const float* const from = input + (y * windows.columns.size + x) * stride + channel;
                    for (std::size_t i = 0; i < Together; ++i)
                        sums[i] = sums[i] + access::load(from + i * width);
                }
            for (std::size_t i = 0; i < Together; ++i)
                access::store(output + o * stride + channel + i * width, quotient(sums[i], count));
        };
        std::size_t channel = 0;
        for (; channel + 4 * width <= stride; channel += 4 * width)
            average(std::integral_constant<std::size_t, 4>{}, channel);
        for (; channel + 2 * width <= stride; channel += 2 * width)
            average(std::integral_constant<std::size_t, 2>{}, channel);
        for (; channel < stride; channel += width)
            average(std::integral_constant<std::size_t, 1>{}, channel);
    });
}

/// output = the sum of each window ÷ its divisor. `Stride` elements from one pixel to the next, in both maps.
template <pooling_windows Windows, std::size_t Stride>
void average_frame(const float* input, float* output) {
    using wide = typename decltype(pixel_vector<float, Stride>())::type;
    if constexpr (reduces_columns(Windows))
        reduce_frame<Windows, Stride, wide>(
            input, output, [](const wide& a, const wide& b) { return a + b; },
            [](const wide& sum, std::size_t divisor) {
                return sum * wide(1 / static_cast<float>(divisor)); // divisions would take longer than sums
            });
    else
        average_pixels<wide>(Windows, Stride, input, output);
}

}}} // namespace tactnet::kernels
