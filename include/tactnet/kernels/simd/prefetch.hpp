#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <cstddef>

// Hints for weights that are not in the near caches: those of large networks, and all if a program did other
// work since the last frame. Weights lie in the order of use, so what comes next also follows in memory, at
// the end of a layer that of the next one. Results do not depend on them.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// How far ahead weights are requested where all taps are one stream.
inline constexpr std::size_t prefetch_distance_bytes = 4096;

/// Requests the cache lines of so many bytes. Does nothing if the layer has few weights, or if each of them
/// is used only once: then the loads themselves keep the memory busy. Microcontrollers have no such caches.
template <std::size_t Bytes, std::size_t LayerBytes, std::size_t Uses>
[[gnu::always_inline]] inline void prefetch_weights([[maybe_unused]] const void* from) {
    if constexpr (LayerBytes >= 64 * 1024 && Uses > 1 && lanes<float> > 1 && vector_registers >= 16) {
        const char* const first = static_cast<const char*>(from);
#pragma GCC unroll 64
        for (std::size_t byte = 0; byte < Bytes; byte += cache_line)
            __builtin_prefetch(first + byte);
    }
}

}}} // namespace tactnet::kernels
