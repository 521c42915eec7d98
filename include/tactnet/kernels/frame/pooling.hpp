#pragma once

#include <tactnet/kernels/simd/compiler_vector.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/pooling_windows.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Pooling of one frame that lies pixel by pixel, of floats or bytes: maximum over windows that overlap, which
// a convolution cannot fuse; averages of floats.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The widest vector that divides the elements of a pixel; a number by itself where none does.
template <class T, std::size_t Stride>
[[nodiscard]] constexpr auto pixel_vector() {
    if constexpr (std::is_same_v<T, std::uint8_t>) {
        return std::type_identity<uint8_vec<widest_bytes(Stride)>>{};
    } else if constexpr (Stride % min_lanes<float> != 0) {
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

/// Loads, stores and compares pixels as `Vector`, which may be float.
template <class Vector>
struct pixel_access {
    static constexpr bool simd = requires(const float* from) { Vector::load_aligned(from); };

    template <class T>
    [[gnu::always_inline]] static Vector load(const T* from) {
        if constexpr (simd)
            return load_as<Vector>(from);
        else
            return load_bytes_as<Vector>(from);
    }
    template <class T>
    [[gnu::always_inline]] static void store(T* to, const Vector& value) {
        if constexpr (simd)
            store_as(to, value);
        else
            store_any(to, value);
    }
    [[gnu::always_inline]] static Vector larger(const Vector& a, const Vector& b) {
        if constexpr (simd)
            return maximum_or_second(a, b);
        else
            return a > b ? a : b;
    }
};

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

/// output = the largest value of each window. `Stride` elements from one pixel to the next, in both maps.
template <sliding_window W, std::size_t Stride, class T>
[[gnu::flatten]] void pool_frame(const T* input, T* output) {
    using wide = typename decltype(pixel_vector<T, Stride>())::type;
    using pixels = pixel_access<wide>;
    constexpr std::size_t width = sizeof(wide) / sizeof(T);
    for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
        const auto at = [&](std::size_t y, std::size_t x, std::size_t channel) {
            return pixels::load(input + (y * W.input.columns + x) * Stride + channel);
        };
        constexpr std::size_t kernel_rows = W.kernel.rows, kernel_columns = W.kernel.columns;
        constexpr bool many = W.kernel.area() > 16;
        if (!many && rows.end - rows.begin == kernel_rows && columns.end - columns.begin == kernel_columns) {
            // Nearly all windows: of known size, unrolled.
            for (std::size_t channel = 0; channel < Stride; channel += width) {
                wide largest = at(rows.begin, columns.begin, channel);
#pragma GCC unroll 8
                for (std::size_t y = 0; y < kernel_rows; ++y)
#pragma GCC unroll 8
                    for (std::size_t x = 0; x < kernel_columns; ++x)
                        largest = pixels::larger(at(rows.begin + y, columns.begin + x, channel), largest);
                pixels::store(output + o * Stride + channel, largest);
            }
            return;
        }
        for (std::size_t channel = 0; channel < Stride; channel += width) {
            const auto here = [&](std::size_t y, std::size_t x) { return at(y, x, channel); };
            pixels::store(output + o * Stride + channel, largest_of < many ? 4 : 1,
                          wide > (rows, columns, here));
        }
    });
}

/// `Vector` divides `stride`: one instantiation for each.
template <class Vector, class T>
void largest_pixels(const average_windows& bins, std::size_t stride, const T* input, T* output) {
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
void pool_frame(const average_windows& bins, const T* input, T* output) {
    largest_pixels<typename decltype(pixel_vector<T, Stride>())::type>(bins, Stride, input, output);
}

/// `Vector` divides `stride`: one instantiation for each. Sums of several vectors side by side do not wait
/// for one another.
template <class Vector>
void average_pixels(const average_windows& windows, std::size_t stride, const float* input, float* output) {
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
                access::store(output + o * stride + channel + i * width, sums[i] / count);
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
template <average_windows Windows, std::size_t Stride>
void average_frame(const float* input, float* output) {
    using wide = typename decltype(pixel_vector<float, Stride>())::type;
    using access = pixel_access<wide>;
    constexpr std::size_t width = sizeof(wide) / sizeof(float), kernel_rows = Windows.rows.kernel,
                          kernel_columns = Windows.columns.kernel;
    if constexpr (kernel_rows == 0 || kernel_columns == 0 || kernel_rows * kernel_columns > 16) {
        average_pixels<wide>(Windows, Stride, input, output);
    } else {
        // Nearly all windows are whole: unrolled, so that the processor works on several at a time.
        Windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
            const float* const from = input + (rows.begin * Windows.columns.size + columns.begin) * Stride;
            const bool whole =
                rows.end - rows.begin == kernel_rows && columns.end - columns.begin == kernel_columns;
            const wide count(static_cast<float>(divisor));
            for (std::size_t channel = 0; channel < Stride; channel += width) {
                wide sum(0.0f);
                const auto add = [&](std::size_t y, std::size_t x) __attribute__((always_inline)) {
                    sum = sum + access::load(from + (y * Windows.columns.size + x) * Stride + channel);
                };
                if (whole) {
#pragma GCC unroll 16
                    for (std::size_t y = 0; y < kernel_rows; ++y)
#pragma GCC unroll 16
                        for (std::size_t x = 0; x < kernel_columns; ++x)
                            add(y, x);
                } else {
                    for (std::size_t y = 0; y < rows.end - rows.begin; ++y)
                        for (std::size_t x = 0; x < columns.end - columns.begin; ++x)
                            add(y, x);
                }
                access::store(output + o * Stride + channel, sum / count);
            }
        });
    }
}

}}} // namespace tactnet::kernels
