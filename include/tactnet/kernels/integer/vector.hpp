#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>

// Vectors of whole numbers and of single precision beside them, as the compiler has them: xsimd has neither
// the products of bytes that networks of 8 bits live on nor conversions that are the same in all its
// versions.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

template <std::size_t Lanes>
struct integer_lanes {
    using integers [[gnu::vector_size(4 * Lanes)]] = std::int32_t;
    using numbers [[gnu::vector_size(4 * Lanes)]] = float;
    using words [[gnu::vector_size(2 * Lanes)]] = std::int16_t;
    using bytes [[gnu::vector_size(Lanes)]] = std::uint8_t;
};
template <std::size_t Lanes>
using integers = typename integer_lanes<Lanes>::integers;
template <std::size_t Lanes>
using numbers = typename integer_lanes<Lanes>::numbers;

/// Lanes of the widest vector of whole numbers that the instruction set multiplies.
#if defined(TACTNET_NO_SIMD)
inline constexpr std::size_t most_integer_lanes = 1;
#elif defined(__AVX512BW__)
inline constexpr std::size_t most_integer_lanes = 16;
#elif defined(__AVX2__)
inline constexpr std::size_t most_integer_lanes = 8;
#else
inline constexpr std::size_t most_integer_lanes = 4;
#endif

template <std::size_t Lanes>
struct byte_lanes {
    using bytes [[gnu::vector_size(Lanes)]] = std::uint8_t;
};
/// Lanes of the widest vector of bytes that divides `count`.
[[nodiscard]] constexpr std::size_t widest_bytes(std::size_t count) {
    std::size_t width = 4 * most_integer_lanes;
    while (count % width != 0)
        width /= 2;
    return width;
}

/// Of any alignment, and of memory that was written as another type.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector load_any(const void* from) {
    Vector values;
    std::memcpy(&values, from, sizeof(values));
    return values;
}
template <class Vector>
[[gnu::always_inline]] inline void store_any(void* to, const Vector& values) {
    std::memcpy(to, &values, sizeof(values));
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
