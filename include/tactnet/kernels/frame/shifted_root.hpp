#pragma once

#include <tactnet/kernels/batch/elementwise.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Square roots of one frame, of any number of elements.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// As shifted_root_forward, whose bits these are. Both maps begin on a vector's boundary.
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
