#pragma once

#include <tactnet/kernels/simd/compiler_vector.hpp>

#include <cstddef>
#include <cstring>

// Widths, loads and stores of integer vectors. Their types are in simd/compiler_vector.hpp.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Lanes of the widest vector of 32-bit integers that the instruction set multiplies.
#if defined(TACTNET_NO_SIMD)
inline constexpr std::size_t max_integer_lanes = 1;
#elif defined(__AVX512BW__)
inline constexpr std::size_t max_integer_lanes = 16;
#elif defined(__AVX2__)
inline constexpr std::size_t max_integer_lanes = 8;
#else
inline constexpr std::size_t max_integer_lanes = 4;
#endif

/// Lanes of the widest vector of bytes that divides `count`.
[[nodiscard]] constexpr std::size_t widest_bytes(std::size_t count) {
    std::size_t width = 4 * max_integer_lanes;
    while (count % width != 0)
        width /= 2;
    return width;
}

/// Loads from any alignment, and from memory that was written as another type.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector load_any(const void* from) {
    Vector values;
    std::memcpy(&values, from, sizeof(values));
    return values;
}
/// Stores to any alignment.
template <class Vector>
[[gnu::always_inline]] inline void store_any(void* to, const Vector& values) {
    std::memcpy(to, &values, sizeof(values));
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
