#pragma once

#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// sums[c] = Σ weights[r] · rows[r][c] in double, in the order of the rows. `width`, the length of a row, is
/// a multiple of the lanes; rows and sums are aligned.
inline void weighted_row_sums(const float* weights, const double* rows, std::size_t count, std::size_t width,
                              double* sums) {
    using v = vector<double>;
    std::fill_n(sums, width, 0.0);
    for (std::size_t r = 0; r < count; ++r) {
        const v weight(static_cast<double>(weights[r]));
        for (std::size_t c = 0; c < width; c += lanes<double>)
            store(sums + c, multiply_add(weight, load(rows + r * width + c), load(sums + c)));
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
