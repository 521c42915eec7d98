#pragma once

#include <tactnet/kernels/batch/average_pooling.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <cstddef>
#include <type_traits>

// Averages of one frame that lies pixel by pixel.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// The widest vector that divides the elements of a pixel; a number by itself where none does.
template <std::size_t Stride>
[[nodiscard]] constexpr auto pixel_vector() {
    if constexpr (Stride % fewest_lanes<float> != 0) {
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
