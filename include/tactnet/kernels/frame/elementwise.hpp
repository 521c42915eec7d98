#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

// Elementwise operations on one frame: normalisation of its counts, square roots.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// to[i] = (counts[i] − mean[i]) × scale for `Size` counts in bytes or floats, of any alignment. Returns
/// whether all results are finite and within ± limit; for bytes the caller chooses the limit so that they
/// are. Written in vectors because compilers leave a plain loop scalar in some callers, where it then takes
/// as long as a layer.
template <std::size_t Size, class Count>
[[nodiscard]] inline bool normalise_counts(const Count* counts, const float* mean, float scale, float limit,
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
                (load_floats<wide>(counts + at) - load_anywhere<wide>(mean + at)) * wide(scale);
            store_anywhere(to + at, number);
            // The difference is 0 within the limits, infinite for an infinity and NaN for NaN.
            if constexpr (!always_usual)
                beyond = select_if_zero(clamp(number, wide(-limit), wide(limit)) - number, beyond,
                                        wide(std::numeric_limits<float>::infinity()));
        }
        return all_finite(beyond);
    }
}

/// Square roots of `Count` elements, bit-identical with shifted_root_forward. Both maps are aligned.
template <std::size_t Count>
void shifted_roots(float offset, const float* input, float* output) {
    constexpr std::size_t whole = Count / lanes<float> * lanes<float>;
    shifted_root_forward(offset, input, output, whole);
    if constexpr (whole < Count) {
        alignas(alignment) std::array<float, lanes<float>> rest{};
        std::copy_n(input + whole, Count - whole, rest.begin());
        shifted_root_forward(offset, rest.data(), rest.data(), lanes<float>);
        std::copy_n(rest.begin(), Count - whole, output + whole);
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
