#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/pooling_windows.hpp>

#include <cstddef>
#include <type_traits>

// Pooling of one frame that lies pixel by pixel: maximum over windows that overlap, which a convolution
// cannot fuse, and averages.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// The widest vector that divides the elements of a pixel; a number by itself where none does.
template <std::size_t Stride>
[[nodiscard]] constexpr auto pixel_vector() {
    if constexpr (Stride % min_lanes<float> != 0) {
        return std::type_identity<float>{};
    } else {
        constexpr std::size_t width = [] {
            std::size_t w = lanes<float>;
            while (Stride % w != 0)
                w /= 2;
            return w;
        }();
        return std::type_identity<sized_vector<float, width>>{};
    }
}

/// output = the largest value of each window. `Stride` elements from one pixel to the next, in both maps.
template <sliding_window W, std::size_t Stride>
[[gnu::flatten]] void pool_frame(const float* input, float* output) {
    const auto pool = [&](auto width, auto load_pixel, auto store_pixel, auto largest_of) {
        for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            const auto at = [&](std::size_t y, std::size_t x, std::size_t channel) {
                return load_pixel(input + (y * W.input.columns + x) * Stride + channel);
            };
            constexpr std::size_t kernel_rows = W.kernel.rows, kernel_columns = W.kernel.columns;
            if (rows.end - rows.begin == kernel_rows && columns.end - columns.begin == kernel_columns) {
                // Nearly all windows: of known size, written out.
                for (std::size_t channel = 0; channel < Stride; channel += width) {
                    auto largest = at(rows.begin, columns.begin, channel);
#pragma GCC unroll 8
                    for (std::size_t y = 0; y < kernel_rows; ++y)
#pragma GCC unroll 8
                        for (std::size_t x = 0; x < kernel_columns; ++x)
                            largest = largest_of(at(rows.begin + y, columns.begin + x, channel), largest);
                    store_pixel(output + o * Stride + channel, largest);
                }
                return;
            }
            for (std::size_t channel = 0; channel < Stride; channel += width) {
                auto largest = at(rows.begin, columns.begin, channel);
                for (std::size_t y = rows.begin; y < rows.end; ++y)
                    for (std::size_t x = columns.begin; x < columns.end; ++x)
                        largest = largest_of(at(y, x, channel), largest);
                store_pixel(output + o * Stride + channel, largest);
            }
        });
    };
    if constexpr (Stride % min_lanes<float> == 0) {
        constexpr std::size_t width = [] {
            std::size_t w = lanes<float>;
            while (Stride % w != 0)
                w /= 2;
            return w;
        }();
        using wide = sized_vector<float, width>;
        pool(
            constant<width>{}, [](const float* from) { return load_as<wide>(from); },
            [](float* to, const wide& value) { store_as(to, value); },
            [](const wide& a, const wide& b) { return maximum_or_second(a, b); });
    } else {
        pool(
            constant<1>{}, [](const float* from) { return *from; },
            [](float* to, float value) { *to = value; }, [](float a, float b) { return a > b ? a : b; });
    }
}

/// `Vector` is one of those that divide `stride`: compiled once for each.
template <class Vector>
void average_pixels(const average_windows& windows, std::size_t stride, const float* input, float* output) {
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    const auto load_from = [](const float* from) {
        if constexpr (std::is_same_v<Vector, float>)
            return *from;
        else
            return load_as<Vector>(from);
    };
    const std::size_t columns_of_input = windows.columns.size;
    windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
        for (std::size_t channel = 0; channel < stride; channel += width) {
            Vector sum(0.0f);
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    sum = sum + load_from(input + (y * columns_of_input + x) * stride + channel);
            sum = sum / Vector(static_cast<float>(divisor));
            if constexpr (std::is_same_v<Vector, float>)
                output[o * stride + channel] = sum;
            else
                store_as(output + o * stride + channel, sum);
        }
    });
}

/// output = the sum of each window ÷ its divisor. `Stride` elements from one pixel to the next, in both maps.
template <std::size_t Stride>
void average_frame(const average_windows& windows, const float* input, float* output) {
    using wide = typename decltype(pixel_vector<Stride>())::type;
    average_pixels<wide>(windows, Stride, input, output);
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
