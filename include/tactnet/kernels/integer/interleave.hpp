#pragma once

#include <tactnet/kernels/simd/compiler_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#if !defined(TACTNET_NO_SIMD) && defined(__SSE2__)
#include <immintrin.h>
#endif

// Four vectors of bytes interleaved to lanes of 32 bits, with one byte of each vector per lane, and the
// inverse. Instructions interleave within 16 bytes, hence the order: lane j of result v holds the bytes at 16
// (j / 4) + 4 v + j % 4.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The lane of a byte's place, counted over the four results: v × Lanes + j.
template <std::size_t Lanes>
[[nodiscard]] constexpr std::size_t interleaved_place(std::size_t byte) {
    return byte % 16 / 4 * Lanes + byte / 16 * 4 + byte % 4;
}

namespace detail {

/// Alternates elements of a and b, from the lower or the upper half of each 16 bytes.
template <bool Upper, class Vector, std::size_t... I>
[[gnu::always_inline]] inline Vector in_turns(const Vector& a, const Vector& b, std::index_sequence<I...>) {
    constexpr std::size_t n = sizeof...(I), row = 16 * n / sizeof(Vector);
    return __builtin_shufflevector(
        a, b, static_cast<int>(I / row * row + (Upper ? row / 2 : 0) + I % row / 2 + I % 2 * n)...);
}
/// Keeps the low halves of the elements: within each 16 bytes those of a, then those of b.
template <class Vector, std::size_t... I>
[[gnu::always_inline]] inline Vector low_halves(const Vector& a, const Vector& b, std::index_sequence<I...>) {
    constexpr std::size_t n = sizeof...(I), row = 16 * n / sizeof(Vector);
    return __builtin_shufflevector(
        a, b, static_cast<int>(I / row * row + I % (row / 2) * 2 + I % row / (row / 2) * n)...);
}

} // namespace detail

/// Interleaves four vectors: a lane holds a byte of a, b, c and d, in this order.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline std::array<uint8_vec<4 * Lanes>, 4>
interleave(const uint8_vec<4 * Lanes>& a, const uint8_vec<4 * Lanes>& b, const uint8_vec<4 * Lanes>& c,
           const uint8_vec<4 * Lanes>& d) {
    using bytes = uint8_vec<4 * Lanes>;
    using words = int16_vec<2 * Lanes>;
    constexpr std::make_index_sequence<4 * Lanes> all;
    constexpr std::make_index_sequence<2 * Lanes> half;
    const auto lower_ab = reinterpret_cast<words>(detail::in_turns<false>(a, b, all)),
               lower_cd = reinterpret_cast<words>(detail::in_turns<false>(c, d, all)),
               upper_ab = reinterpret_cast<words>(detail::in_turns<true>(a, b, all)),
               upper_cd = reinterpret_cast<words>(detail::in_turns<true>(c, d, all));
    return {reinterpret_cast<bytes>(detail::in_turns<false>(lower_ab, lower_cd, half)),
            reinterpret_cast<bytes>(detail::in_turns<true>(lower_ab, lower_cd, half)),
            reinterpret_cast<bytes>(detail::in_turns<false>(upper_ab, upper_cd, half)),
            reinterpret_cast<bytes>(detail::in_turns<true>(upper_ab, upper_cd, half))};
}

/// Narrows integers from 0 to 255, in the order of `interleave`, to bytes in their own order.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline uint8_vec<4 * Lanes>
narrow(const std::array<int32_vec<Lanes>, 4>& whole) {
    using bytes = uint8_vec<4 * Lanes>;
#if !defined(TACTNET_NO_SIMD) && defined(__SSE2__)
    if constexpr (Lanes == 4) {
        const auto lane = [&](std::size_t v) { return reinterpret_cast<__m128i>(whole[v]); };
        return reinterpret_cast<bytes>(
            _mm_packus_epi16(_mm_packs_epi32(lane(0), lane(1)), _mm_packs_epi32(lane(2), lane(3))));
    }
    // GCC 12 takes the lower half of a packed vector for the packed lower half of the first operand; it does
    // not look through an empty instruction.
#ifdef __AVX2__
    if constexpr (Lanes == 8) {
        const auto lane = [&](std::size_t v) { return reinterpret_cast<__m256i>(whole[v]); };
        __m256i packed =
            _mm256_packus_epi16(_mm256_packs_epi32(lane(0), lane(1)), _mm256_packs_epi32(lane(2), lane(3)));
        asm("" : "+x"(packed));
        return reinterpret_cast<bytes>(packed);
    }
#endif
#ifdef __AVX512BW__
    if constexpr (Lanes == 16) {
        const auto lane = [&](std::size_t v) { return reinterpret_cast<__m512i>(whole[v]); };
        __m512i packed =
            _mm512_packus_epi16(_mm512_packs_epi32(lane(0), lane(1)), _mm512_packs_epi32(lane(2), lane(3)));
        asm("" : "+v"(packed));
        return reinterpret_cast<bytes>(packed);
    }
#endif
#else
    using words = int16_vec<2 * Lanes>;
    const auto pair = [&](std::size_t v) {
        return reinterpret_cast<bytes>(detail::low_halves(reinterpret_cast<words>(whole[v]),
                                                          reinterpret_cast<words>(whole[v + 1]),
                                                          std::make_index_sequence<2 * Lanes>{}));
    };
    return detail::low_halves(pair(0), pair(2), std::make_index_sequence<4 * Lanes>{});
#endif
}

/// Loads the first `Count` bytes of a vector of `Bytes`, and reads no others; the rest is zero.
template <std::size_t Bytes, std::size_t Count>
[[nodiscard]] [[gnu::always_inline]] inline uint8_vec<Bytes> load_first(const std::uint8_t* from) {
    if constexpr (Count >= Bytes) {
        return load_bytes_as<uint8_vec<Bytes>>(from);
    } else if constexpr (Bytes > 16) {
        // By halves, or compilers assemble the vector in memory.
        constexpr std::size_t half = Bytes / 2;
        uint8_vec<half> upper{};
        if constexpr (Count > half)
            upper = load_first<half, Count - half>(from + half);
        return [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
            return __builtin_shufflevector(load_first<half, std::min(Count, half)>(from), upper,
                                           static_cast<int>(I)...);
        }
        (std::make_index_sequence<Bytes>{});
    } else {
        std::uint64_t lower = 0, upper = 0;
        std::memcpy(&lower, from, std::min<std::size_t>(Count, 8));
        if constexpr (Count > 8)
            std::memcpy(&upper, from + 8, Count - 8);
        using pair [[gnu::vector_size(16)]] = std::uint64_t;
        return reinterpret_cast<uint8_vec<16>>(pair{lower, upper});
    }
}

}}} // namespace tactnet::kernels
