#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>

#if !defined(TACTNET_NO_SIMD) && defined(__AVX2__)
#include <immintrin.h>
#endif

// The compiler's own vectors. xsimd has neither the products of bytes that networks in 8 bits are made of,
// nor conversions that give the same result in all its versions, and xsimd 8 exchanges no lanes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

template <class T, std::size_t Lanes>
struct compiler_vector {
    using type [[gnu::vector_size(sizeof(T) * Lanes)]] = T;
};

} // namespace detail

template <std::size_t Lanes>
using float_vec = typename detail::compiler_vector<float, Lanes>::type;
template <std::size_t Lanes>
using int32_vec = typename detail::compiler_vector<std::int32_t, Lanes>::type;
template <std::size_t Lanes>
using uint32_vec = typename detail::compiler_vector<std::uint32_t, Lanes>::type;
template <std::size_t Lanes>
using int16_vec = typename detail::compiler_vector<std::int16_t, Lanes>::type;
template <std::size_t Lanes>
using uint8_vec = typename detail::compiler_vector<std::uint8_t, Lanes>::type;

// One instruction converts bytes to a whole register of wider integers. GCC 12 converts halves and joins
// them.

/// Converts bytes to 16-bit integers.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int16_vec<Lanes> to_int16(const uint8_vec<Lanes>& values) {
#if !defined(TACTNET_NO_SIMD) && defined(__AVX512BW__)
    if constexpr (Lanes == 32)
        return reinterpret_cast<int16_vec<Lanes>>(_mm512_cvtepu8_epi16(reinterpret_cast<__m256i>(values)));
#endif
#if !defined(TACTNET_NO_SIMD) && defined(__AVX2__)
    if constexpr (Lanes == 16)
        return reinterpret_cast<int16_vec<Lanes>>(_mm256_cvtepu8_epi16(reinterpret_cast<__m128i>(values)));
#endif
    return __builtin_convertvector(values, int16_vec<Lanes>);
}
/// Converts bytes to 32-bit integers. In two steps where there is no instruction: GCC 12 converts lane by
/// lane if the size of an element more than doubles.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> to_int32(const uint8_vec<Lanes>& values) {
#if !defined(TACTNET_NO_SIMD) && defined(__AVX512F__)
    if constexpr (Lanes == 16) // without a mask, GCC 12 warns about its own header
        return reinterpret_cast<int32_vec<Lanes>>(
            _mm512_maskz_cvtepu8_epi32(0xFFFF, reinterpret_cast<__m128i>(values)));
#endif
#if !defined(TACTNET_NO_SIMD) && defined(__AVX2__)
    if constexpr (Lanes == 8)
        return reinterpret_cast<int32_vec<Lanes>>(
            _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(&values))));
#endif
    return __builtin_convertvector(to_int16<Lanes>(values), int32_vec<Lanes>);
}

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
[[nodiscard]] [[gnu::always_inline]] inline Vector load_bytes_as(const void* from) {
    Vector values;
    std::memcpy(&values, from, sizeof(values));
    return values;
}
/// Stores to any alignment.
template <class Vector>
[[gnu::always_inline]] inline void store_any(void* to, const Vector& values) {
    std::memcpy(to, &values, sizeof(values));
}

}}} // namespace tactnet::kernels
