#pragma once

#include <tactnet/kernels/simd/compiler_vector.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>

#if !defined(TACTNET_NO_SIMD)
#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif
#elif defined(__arm__) && defined(__ARM_FEATURE_SIMD32) && !defined(__ARM_BIG_ENDIAN)
#include <arm_acle.h>
#endif

// sums += weights · inputs in integers: signed weights of 8 bits times inputs of 8 or 16 bits, exactly, in
// sums of 32 bits. An instruction multiplies a `group` of neighbouring inputs, broadcast to all lanes, by as
// many weights of one filter per lane: [filter][input of the group]. Every intermediate sum has 32 bits, so
// nothing saturates.
//
// clang-format off
// Members of products:
//   staged     the type of inputs in memory while they are multiplied
//   weight     the type of weights: 16 bits if inputs have 16, since widening takes as long as a product
//   group      inputs per instruction
//   offset     subtracted from an input of 8 bits as it is staged
//   order      optional: the input that each weight of a group belongs to, if in another order
//   max_sums  optional: sums that stay in registers, if fewer than of floats
// clang-format on

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// Loads the bits of a group from any address.
template <class Group>
[[nodiscard]] [[gnu::always_inline]] inline Group group_at(const void* from) {
    Group bits;
    std::memcpy(&bits, from, sizeof(bits));
    return bits;
}

#if !defined(TACTNET_NO_SIMD) && defined(__SSE2__)
/// sum += products of neighbouring words, as two adjacent instructions: compilers, which may reorder products
/// and sums, would compute all products first and keep the sums in memory. A sum keeps one type throughout,
/// since compilers copy where types change.
template <class Sum, class Words>
[[nodiscard]] [[gnu::always_inline]] inline Sum add_products(Sum sum, const Words& w, const Words& x) {
    Words product;
#if defined(__AVX512F__)
    asm("vpmaddwd %3, %2, %1\n\tvpaddd %1, %0, %0" : "+v"(sum), "=&v"(product) : "v"(w), "v"(x));
#elif defined(__AVX__)
    asm("vpmaddwd %3, %2, %1\n\tvpaddd %1, %0, %0" : "+x"(sum), "=&x"(product) : "x"(w), "x"(x));
#else
    asm("movdqa %2, %1\n\tpmaddwd %3, %1\n\tpaddd %1, %0" : "+x"(sum), "=&x"(product) : "x"(w), "x"(x));
#endif
    return sum;
}
#elif !defined(TACTNET_NO_SIMD) && defined(__aarch64__)
/// Keeps an integer sum at its place in the order of the program.
template <class Register>
[[nodiscard]] [[gnu::always_inline]] inline Register in_order(Register sum) {
    asm("" : "+w"(sum));
    return sum;
}
#endif

} // namespace detail

/// Instructions for the products of a group of words and their addition to the sums.
#if !defined(TACTNET_NO_SIMD) && ((defined(__AVX512VNNI__) && defined(__AVX512VL__)) || defined(__AVXVNNI__))
inline constexpr std::size_t word_product_cost = 1;
#else
inline constexpr std::size_t word_product_cost = 2;
#endif

/// Products for inputs of 16 bits. The primary template uses no vector instructions.
template <std::size_t Lanes>
struct word_products {
    using staged = std::int16_t;
    using weight = std::int8_t;
    using weights = int32_vec<Lanes>;
    using inputs = std::int32_t;
    static constexpr std::size_t group = 1;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int8_t* from) {
        weights w{};
        for (std::size_t lane = 0; lane < Lanes; ++lane)
            w[lane] = from[lane];
        return w;
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) { return *from; }
    [[gnu::always_inline]] static int32_vec<Lanes> add(const int32_vec<Lanes>& sums, const weights& w,
                                                       const inputs& x) {
        return sums + w * x;
    }
};

#if !defined(TACTNET_NO_SIMD) && defined(__SSE2__)

template <>
struct word_products<4> {
    using staged = std::int16_t;
    using weight = std::int16_t;
    using weights = __m128i;
    using inputs = __m128i;
    static constexpr std::size_t group = 2;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int16_t* from) {
        return load_bytes_as<__m128i>(from);
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return _mm_set1_epi32(detail::group_at<std::int32_t>(from));
    }
    [[gnu::always_inline]] static int32_vec<4> add(const int32_vec<4>& sums, const weights& w,
                                                   const inputs& x) {
#if defined(__AVX512VNNI__) && defined(__AVX512VL__)
        return reinterpret_cast<int32_vec<4>>(_mm_dpwssd_epi32(reinterpret_cast<__m128i>(sums), w, x));
#elif defined(__AVXVNNI__)
        return reinterpret_cast<int32_vec<4>>(_mm_dpwssd_avx_epi32(reinterpret_cast<__m128i>(sums), w, x));
#else
        return detail::add_products(sums, w, x);
#endif
    }
};

#ifdef __AVX2__
template <>
struct word_products<8> {
    using staged = std::int16_t;
    using weight = std::int16_t;
    using weights = __m256i;
    using inputs = __m256i;
    static constexpr std::size_t group = 2;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int16_t* from) {
        return load_bytes_as<__m256i>(from);
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return _mm256_set1_epi32(detail::group_at<std::int32_t>(from));
    }
    [[gnu::always_inline]] static int32_vec<8> add(const int32_vec<8>& sums, const weights& w,
                                                   const inputs& x) {
#if defined(__AVX512VNNI__) && defined(__AVX512VL__)
        return reinterpret_cast<int32_vec<8>>(_mm256_dpwssd_epi32(reinterpret_cast<__m256i>(sums), w, x));
#elif defined(__AVXVNNI__)
        return reinterpret_cast<int32_vec<8>>(_mm256_dpwssd_avx_epi32(reinterpret_cast<__m256i>(sums), w, x));
#else
        return detail::add_products(sums, w, x);
#endif
    }
};
#endif

#ifdef __AVX512BW__
template <>
struct word_products<16> {
    using staged = std::int16_t;
    using weight = std::int16_t;
    using weights = __m512i;
    using inputs = __m512i;
    static constexpr std::size_t group = 2;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int16_t* from) {
        return load_bytes_as<__m512i>(from);
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return _mm512_set1_epi32(detail::group_at<std::int32_t>(from));
    }
    [[gnu::always_inline]] static int32_vec<16> add(const int32_vec<16>& sums, const weights& w,
                                                    const inputs& x) {
#ifdef __AVX512VNNI__
        return reinterpret_cast<int32_vec<16>>(_mm512_dpwssd_epi32(reinterpret_cast<__m512i>(sums), w, x));
#else
        return detail::add_products(sums, w, x);
#endif
    }
};
#endif

#elif defined(__arm__) && defined(__ARM_FEATURE_SIMD32) && !defined(__ARM_BIG_ENDIAN)

// Pairs of words in general registers: Cortex-M4 and M7, and 32-bit ARM since version 6.

template <>
struct word_products<1> {
    using staged = std::int16_t;
    using weight = std::int16_t;
    using weights = int16x2_t;
    using inputs = int16x2_t;
    static constexpr std::size_t group = 2;
    static constexpr int offset = 0;
    static constexpr std::size_t max_sums = 4; // of 14 registers

    [[gnu::always_inline]] static weights load(const std::int16_t* from) {
        return detail::group_at<weights>(from);
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return detail::group_at<inputs>(from);
    }
    [[gnu::always_inline]] static int32_vec<1> add(const int32_vec<1>& sums, const weights& w,
                                                   const inputs& x) {
        return int32_vec<1>{__smlad(w, x, sums[0])};
    }
};

#elif !defined(TACTNET_NO_SIMD) && defined(__aarch64__)

template <>
struct word_products<4> {
    using staged = std::int16_t;
    using weight = std::int16_t;
    using weights = int16x4_t;
    using inputs = std::int16_t;
    static constexpr std::size_t group = 1;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int16_t* from) { return vld1_s16(from); }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) { return *from; }
    [[gnu::always_inline]] static int32_vec<4> add(const int32_vec<4>& sums, const weights& w,
                                                   const inputs& x) {
        return detail::in_order(vmlal_n_s16(sums, w, x));
    }
};

#elif !defined(TACTNET_NO_SIMD) && defined(__wasm_simd128__)

template <>
struct word_products<4> {
    using staged = std::int16_t;
    using weight = std::int16_t;
    using weights = v128_t;
    using inputs = v128_t;
    static constexpr std::size_t group = 2;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int16_t* from) { return wasm_v128_load(from); }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return wasm_i32x4_splat(detail::group_at<std::int32_t>(from));
    }
    [[gnu::always_inline]] static int32_vec<4> add(const int32_vec<4>& sums, const weights& w,
                                                   const inputs& x) {
        return reinterpret_cast<int32_vec<4>>(
            wasm_i32x4_add(reinterpret_cast<v128_t>(sums), wasm_i32x4_dot_i16x8(w, x)));
    }
};

#endif

}}} // namespace tactnet::kernels
