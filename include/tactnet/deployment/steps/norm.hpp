#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A batch norm that follows no convolution, with or without ReLU: a factor and an offset for each channel.
template <class Format, shape Map, std::size_t Stride, bool Rectified>
struct norm_step;

template <shape Map, std::size_t Stride, bool Rectified>
struct norm_step<single_precision, Map, Stride, Rectified> {
    using format = single_precision;
    static constexpr shape output = Map;
    static constexpr std::size_t output_stride = Stride;
    static constexpr std::size_t folded = 2 * Map.channels, packed = 2 * whole_lines(Stride);
    static constexpr std::size_t workspace_elements = 0;

    static constexpr void pack(const float* from, float* to) {
        std::copy_n(from, Map.channels, to);
        std::copy_n(from + Map.channels, Map.channels, to + whole_lines(Stride));
    }
    static double output_bound(const float* from, double input) {
        return detail::largest_sum(from, Map.channels, 1, input);
    }
    static void run(const float* factors, const float* in, float* out, float*) noexcept {
        const float* offsets = factors + whole_lines(Stride);
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; ++c) {
                const float y = kernels::fused_multiply_add(in[pixel + c], factors[c], offsets[c]);
                out[pixel + c] = Rectified && y < 0 ? 0 : y;
            }
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
