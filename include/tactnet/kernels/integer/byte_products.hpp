#pragma once

#include <tactnet/kernels/integer/word_products.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

// Products of unsigned bytes and signed weights of 8 bits, four inputs at once, for instruction sets that
// have them. word_products.hpp describes the members.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Products for unsigned inputs of 8 bits. The primary template uses products of 16 bits.
template <std::size_t Lanes>
struct byte_products : word_products<Lanes> {};

#if !defined(TACTNET_NO_SIMD) && ((defined(__AVX512VNNI__) && defined(__AVX512VL__)) || defined(__AVXVNNI__))

template <>
struct byte_products<4> {
    using staged = std::uint8_t;
    using weight = std::int8_t;
    using weights = __m128i;
    using inputs = __m128i;
    static constexpr std::size_t group = 4;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int8_t* from) {
        return load_bytes_as<__m128i>(from);
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return _mm_set1_epi32(detail::group_at<std::int32_t>(from));
    }
    [[gnu::always_inline]] static int32_vec<4> add(const int32_vec<4>& sums, const weights& w,
                                                   const inputs& x) {
        const auto s = reinterpret_cast<__m128i>(sums);
#ifdef __AVX512VNNI__
        return reinterpret_cast<int32_vec<4>>(_mm_dpbusd_epi32(s, x, w));
#else
        return reinterpret_cast<int32_vec<4>>(_mm_dpbusd_avx_epi32(s, x, w));
#endif
    }
};
template <>
struct byte_products<8> {
    using staged = std::uint8_t;
    using weight = std::int8_t;
    using weights = __m256i;
    using inputs = __m256i;
    static constexpr std::size_t group = 4;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int8_t* from) {
        return load_bytes_as<__m256i>(from);
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return _mm256_set1_epi32(detail::group_at<std::int32_t>(from));
    }
    [[gnu::always_inline]] static int32_vec<8> add(const int32_vec<8>& sums, const weights& w,
                                                   const inputs& x) {
        const auto s = reinterpret_cast<__m256i>(sums);
#ifdef __AVX512VNNI__
        return reinterpret_cast<int32_vec<8>>(_mm256_dpbusd_epi32(s, x, w));
#else
        return reinterpret_cast<int32_vec<8>>(_mm256_dpbusd_avx_epi32(s, x, w));
#endif
    }
};
#ifdef __AVX512VNNI__
template <>
struct byte_products<16> {
    using staged = std::uint8_t;
    using weight = std::int8_t;
    using weights = __m512i;
    using inputs = __m512i;
    static constexpr std::size_t group = 4;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int8_t* from) {
        return load_bytes_as<__m512i>(from);
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return _mm512_set1_epi32(detail::group_at<std::int32_t>(from));
    }
    [[gnu::always_inline]] static int32_vec<16> add(const int32_vec<16>& sums, const weights& w,
                                                    const inputs& x) {
        return reinterpret_cast<int32_vec<16>>(_mm512_dpbusd_epi32(reinterpret_cast<__m512i>(sums), x, w));
    }
};
#endif

#elif !defined(TACTNET_NO_SIMD) && defined(__ARM_FEATURE_DOTPROD)

template <>
struct byte_products<4> {
    using staged = std::int8_t;
    using weight = std::int8_t;
    using weights = int8x16_t;
    using inputs = int8x16_t;
    static constexpr std::size_t group = 4;
    static constexpr int offset = 128; // this instruction multiplies signed bytes only

    [[gnu::always_inline]] static weights load(const std::int8_t* from) { return vld1q_s8(from); }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return vreinterpretq_s8_s32(vdupq_n_s32(detail::group_at<std::int32_t>(from)));
    }
    [[gnu::always_inline]] static int32_vec<4> add(const int32_vec<4>& sums, const weights& w,
                                                   const inputs& x) {
        return vdotq_s32(sums, w, x);
    }
};

#elif defined(__arm__) && defined(__ARM_FEATURE_SIMD32) && !defined(__ARM_BIG_ENDIAN)

/// Weights are bytes in memory and pairs of words in registers. One instruction widens the even bytes of a
/// register, another the odd bytes, hence the order.
template <>
struct byte_products<1> {
    using staged = std::int16_t;
    using weight = std::int8_t;
    struct pairs {
        int16x2_t first, second;
    };
    using weights = pairs;
    using inputs = pairs;
    static constexpr std::size_t group = 4;
    static constexpr int offset = 0;
    static constexpr std::array<std::size_t, group> order{0, 2, 1, 3};
    static constexpr std::size_t max_sums = word_products<1>::max_sums;

    [[gnu::always_inline]] static weights load(const std::int8_t* from) {
        const auto bytes = detail::group_at<int8x4_t>(from);
        int16x2_t second;
        // __sxtb16 of the bytes turned by 8 would be two instructions.
        asm("sxtb16 %0, %1, ror #8" : "=r"(second) : "r"(bytes));
        return {__sxtb16(bytes), second};
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) {
        return {detail::group_at<int16x2_t>(from), detail::group_at<int16x2_t>(from + 2)};
    }
    [[gnu::always_inline]] static int32_vec<1> add(const int32_vec<1>& sums, const weights& w,
                                                   const inputs& x) {
        return int32_vec<1>{__smlad(w.second, x.second, __smlad(w.first, x.first, sums[0]))};
    }
};

#endif

}}} // namespace tactnet::kernels
