#pragma once

#include <tactnet/kernels/frame/pixels.hpp>
#include <tactnet/kernels/simd/xsimd.hpp>

#include <array>
#include <cstddef>

// Separable resampling of one frame that lies pixel by pixel, with compile-time weights
// (kernels/sampling_axis.hpp).

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// to[i] = Σ weights[t] · from[t · distance + i] for `Count` elements. A weight of zero is no tap.
template <class Vector, std::size_t Count, std::size_t Taps>
void weighted_sum(const std::array<double, Taps>& weights, const float* from, std::size_t distance,
                  float* to) {
    using pixels = pixel_access<Vector>;
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    for (std::size_t i = 0; i < Count; i += width) {
        Vector sum(0.0f);
        for (std::size_t t = 0; t < Taps; ++t)
            if (weights[t] != 0)
                sum = fused_multiply_add(Vector(static_cast<float>(weights[t])),
                                         pixels::load(from + t * distance + i), sum);
        pixels::store(to + i, sum);
    }
}

} // namespace detail

/// output = the resampled frame. `Stride` elements from one pixel to the next, in both maps; `line` has room
/// for a row of the input.
template <class Down, class Along, std::size_t Stride>
void resample_frame(const float* input, float* output, float* line) {
    using wide = typename decltype(pixel_vector<float, Stride>())::type;
    constexpr std::size_t row_elements = Along::inputs * Stride;
    for (const auto& above : Down::table) {
        detail::weighted_sum<wide, row_elements>(above.weights, input + above.first * row_elements,
                                                 row_elements, line);
        for (const auto& beside : Along::table) {
            detail::weighted_sum<wide, Stride>(beside.weights, line + beside.first * Stride, Stride, output);
            output += Stride;
        }
    }
}

}}} // namespace tactnet::kernels
