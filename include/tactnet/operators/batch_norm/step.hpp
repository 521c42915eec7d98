#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A batch norm that no convolution has fused, with or without ReLU: a factor and an offset per channel.
template <class Format, shape Map, std::size_t Stride, bool Rectified>
struct norm_step;
template <class Format, shape Map, std::size_t Stride, bool Rectified>
struct step_description<norm_step<Format, Map, Stride, Rectified>> {
    static constexpr const char* header = "tactnet/operators/batch_norm/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::norm_step", Rectified ? "Batch norm, ReLU" : "Batch norm", std::type_identity<Format>{},
           Map, input_stride_argument{}, Rectified);
    }
};

template <shape Map, std::size_t Stride, bool Rectified>
struct norm_step<single_precision, Map, Stride, Rectified> : step_base<single_precision, Map, Stride> {
    static constexpr std::size_t folded_elements = 2 * Map.channels,
                                 packed_elements = 2 * pad_to_cache_line(Stride);

    static constexpr void pack(const float* from, float* to) {
        std::copy_n(from, Map.channels, to);
        std::copy_n(from + Map.channels, Map.channels, to + pad_to_cache_line(Stride));
    }
    static double output_bound(const float* from, double input) {
        return detail::largest_sum(from, Map.channels, 1, input);
    }
    static void run(const float* factors, const float* in, float* out, float*) noexcept {
        const float* offsets = factors + pad_to_cache_line(Stride);
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; ++c) {
                const float y = kernels::fused_multiply_add(in[pixel + c], factors[c], offsets[c]);
                out[pixel + c] = Rectified && y < 0 ? 0 : y;
            }
    }
};

}} // namespace tactnet
