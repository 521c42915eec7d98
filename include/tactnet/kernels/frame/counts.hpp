#pragma once

#include <tactnet/kernels/simd/row_vector.hpp>

#include <cstddef>
#include <limits>
#include <type_traits>

// Where a frame comes in: from counts to the numbers that the first layer sees.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// to[i] = (counts[i] − mean[i]) × scale for `Size` counts in bytes or floats, of any alignment. Whether all
/// of these numbers are finite and within ± limit, as those of bytes are by the choice of the limit. In
/// vectors: compilers leave a plain loop scalar in some of its callers, where it takes as long as a layer.
template <std::size_t Size, class Count>
[[nodiscard]] inline bool counts_to_numbers(const Count* counts, const float* mean, float scale, float limit,
                                            float* to) {
    constexpr std::size_t width = lanes_for<float>(Size);
    constexpr bool always_usual = !std::is_floating_point_v<Count>;
    if constexpr (Size < width) {
        bool usual = true;
        for (std::size_t i = 0; i < Size; ++i) {
            to[i] = (static_cast<float>(counts[i]) - mean[i]) * scale;
            usual = usual && (always_usual || (to[i] <= limit && to[i] >= -limit));
        }
        return usual;
    } else {
        using wide = sized_vector<float, width>;
        wide beyond(0.0f);
        for (std::size_t v = 0; v < row_vectors(Size, width); ++v) {
            const std::size_t at = row_vector_begin(v, Size, width);
            const wide number =
                (load_numbers<wide>(counts + at) - load_anywhere<wide>(mean + at)) * wide(scale);
            store_anywhere(to + at, number);
            // Only what is within is as far from it as 0: an infinity is infinitely far, NaN is NaN.
            if constexpr (!always_usual)
                beyond = where_zero(kept_within(number, wide(-limit), wide(limit)) - number, beyond,
                                    wide(std::numeric_limits<float>::infinity()));
        }
        return all_finite(beyond);
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
