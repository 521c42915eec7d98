#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// The sum of (a[i] − b[i])² over Length values, aligned; whole vectors of them. All terms have one sign, so
/// that nothing cancels.
template <std::size_t Length>
[[nodiscard]] inline float squared_distance(const float* a, const float* b) {
    static_assert(Length % lanes<float> == 0);
    vector<float> squares(0.0f);
    for (std::size_t i = 0; i < Length; i += lanes<float>) {
        const vector<float> difference = load(a + i) - load(b + i);
        squares = multiply_add(difference, difference, squares);
    }
    return add_lanes<float, lanes<float>>(squares);
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
