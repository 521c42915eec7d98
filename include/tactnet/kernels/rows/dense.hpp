#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Products and sums of long rows of floats, aligned and padded with zeros to whole cache lines.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// a · b over `count` floats, a multiple of a cache line. Short runs in single precision, their sums in
/// double.
[[nodiscard]] inline double dot(const float* a, const float* b, std::size_t count) {
    // One line at a time, by as many chains as hide the latency.
    constexpr std::size_t width = lanes<float>, chains = 4, run = 64 * chains * width;
    double total = 0;
    for (std::size_t first = 0; first < count; first += run) {
        const std::size_t end = std::min(first + run, count);
        std::array<vector<float>, chains> sums;
        sums.fill(vector<float>(0.0F));
        std::size_t i = first;
        for (; i + chains * width <= end; i += chains * width)
            for (std::size_t c = 0; c < chains; ++c)
                sums[c] = multiply_add(load(a + i + c * width), load(b + i + c * width), sums[c]);
        for (; i < end; i += width)
            sums[0] = multiply_add(load(a + i), load(b + i), sums[0]);
        total = add_lanes<float, width>((sums[0] + sums[1]) + (sums[2] + sums[3]), total);
    }
    return total;
}

/// to += factor · from, over `count` floats.
inline void add_multiple(float* to, float factor, const float* from, std::size_t count) {
    const vector<float> f(factor);
    for (std::size_t i = 0; i < count; i += lanes<float>)
        store(to + i, multiply_add(f, load(from + i), load(to + i)));
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
