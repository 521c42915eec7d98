#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/kernels/simd/xsimd.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Separable resampling of one frame that lies pixel by pixel, with compile-time weights
// (kernels/sampling_axis.hpp).

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// to[i] = Σ weights[t] · from[t][i] for `Count` elements. A weight of zero is no tap.
template <class Vector, std::size_t Count, std::size_t Taps>
[[gnu::always_inline]] inline void weighted_sum(const std::array<float, Taps>& weights,
                                                const std::array<const float*, Taps>& from, float* to) {
    using pixels = pixel_access<Vector>;
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    const auto sum = [&](auto taps, std::size_t first) __attribute__((always_inline)) {
        for (std::size_t i = 0; i < Count; i += width) {
            Vector result = Vector(weights[first]) * pixels::load(from[first] + i);
            for (std::size_t t = 1; t < taps; ++t)
                result = fused_multiply_add(Vector(weights[t]), pixels::load(from[t] + i), result);
            pixels::store(to + i, result);
        }
    };
    static_assert(Taps <= 2);
    if (weights[0] == 0)
        sum(constant<1>{}, Taps - 1);
    else if (weights[Taps - 1] == 0)
        sum(constant<1>{}, 0);
    else
        sum(constant<Taps>{}, 0);
}

/// The weights of all outputs along an axis. Converted at run time, they would take longer than the sums.
template <class Axis>
inline constexpr auto float_weights = [] {
    std::array<std::array<float, Axis::taps>, Axis::outputs> all{};
    for (std::size_t o = 0; o < Axis::outputs; ++o)
        for (std::size_t t = 0; t < Axis::taps; ++t)
            all[o][t] = static_cast<float>(Axis::table[o].weights[t]);
    return all;
}();

} // namespace detail

/// output = the resampled frame. `Stride` elements from one pixel to the next, in both maps; `lines` has room
/// for two rows of the output. Rows of the input are resampled once, then mixed: most of the work has no
/// weights that change from pixel to pixel.
template <class Down, class Along, std::size_t Stride>
void resample_frame(const float* input, float* output, float* lines) {
    using wide = typename decltype(pixel_vector<float, Stride>())::type;
    constexpr std::size_t row_elements = Along::outputs * Stride;
    const auto line_of = [&](std::size_t row) { return lines + row % 2 * row_elements; };
    for (std::size_t y = 0, ready = 0; y < Down::outputs; ++y, output += row_elements) {
        const std::size_t first = Down::table[y].first;
        for (ready = std::max(ready, first); ready < first + Down::taps; ++ready)
            for (std::size_t x = 0; x < Along::outputs; ++x) {
                const float* const from = input + (ready * Along::inputs + Along::table[x].first) * Stride;
                std::array<const float*, Along::taps> taps;
                for (std::size_t t = 0; t < Along::taps; ++t)
                    taps[t] = from + t * Stride;
                detail::weighted_sum<wide, Stride>(detail::float_weights<Along>[x], taps,
                                                   line_of(ready) + x * Stride);
            }
        std::array<const float*, Down::taps> taps;
        for (std::size_t t = 0; t < Down::taps; ++t)
            taps[t] = line_of(first + t);
        detail::weighted_sum<wide, row_elements>(detail::float_weights<Down>[y], taps, output);
    }
}

/// Copies the nearest pixels of a frame, in floats or bytes: each to all places that it is nearest to.
/// `Stride` elements from one pixel to the next, in both maps.
template <class Down, class Along, std::size_t Stride, class T,
          class Vector = typename decltype(pixel_vector<T, Stride>())::type>
void copy_nearest(const T* input, T* output) {
    using pixels = pixel_access<Vector>;
    constexpr std::size_t row_elements = Along::outputs * Stride;
    for (std::size_t row = 0, end = 0; row < Down::outputs; row = end) {
        const T* const from = input + Down::table[row].first * Along::inputs * Stride;
        while (end < Down::outputs && Down::table[end].first == Down::table[row].first)
            ++end;
        for (std::size_t column = 0; column < Along::outputs; ++column)
            for (std::size_t i = 0; i < Stride; i += sizeof(Vector) / sizeof(T)) {
                const Vector values = pixels::load(from + Along::table[column].first * Stride + i);
                for (std::size_t copy = row; copy < end; ++copy)
                    pixels::store(output + copy * row_elements + column * Stride + i, values);
            }
    }
}

}}} // namespace tactnet::kernels
