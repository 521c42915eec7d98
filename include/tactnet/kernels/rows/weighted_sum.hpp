#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>

#include <cmath>
#include <cstddef>

// Sums of rows with weights, and rows brought to unit length: what descriptors are made of.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// to[0 … Length − 1] = Σ weights[i] · from[i · stride + 0 … Length − 1], over `count` rows. `from`, `stride`
/// and `to` lie on vectors of lanes_for<float>(Length), which divide Length.
template <std::size_t Length>
inline void weighted_sum(const float* from, std::size_t stride, const float* weights, std::size_t count,
                         float* to) {
    constexpr std::size_t width = lanes_for<float>(Length);
    using wide = sized_vector<float, width>;
    static_assert(Length % width == 0);
    for (std::size_t first = 0; first < Length; first += width) {
        wide sum(0.0f);
        for (std::size_t i = 0; i < count; ++i)
            sum = fused_multiply_add(load_as<wide>(from + i * stride + first), wide(weights[i]), sum);
        store_as(to + first, sum);
    }
}

/// The Euclidean length of Length values, aligned; whole vectors of them.
template <std::size_t Length>
[[nodiscard]] inline float length_of(const float* values) {
    constexpr std::size_t width = lanes_for<float>(Length);
    using wide = sized_vector<float, width>;
    static_assert(Length % width == 0);
    wide squares(0.0f);
    for (std::size_t i = 0; i < Length; i += width) {
        const wide v = load_as<wide>(values + i);
        squares = fused_multiply_add(v, v, squares);
    }
    return std::sqrt(add_lanes<float, width>(squares));
}

/// values[i] *= factor, for Length values, aligned; whole vectors of them.
template <std::size_t Length>
inline void scale_values(float* values, float factor) {
    constexpr std::size_t width = lanes_for<float>(Length);
    using wide = sized_vector<float, width>;
    static_assert(Length % width == 0);
    for (std::size_t i = 0; i < Length; i += width)
        store_as(values + i, load_as<wide>(values + i) * wide(factor));
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
