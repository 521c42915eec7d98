#pragma once

#include <tactnet/kernels/arch/avx512.hpp>

#if !defined(TACTNET_NO_SIMD) &&                                                                             \
    ((defined(__AVX512VNNI__) && defined(__AVX512VL__)) || (defined(__AVXVNNI__) && !defined(__AVX512BW__)))

// VNNI, with AVX-512 or AVX2: one instruction multiplies a group and adds its products.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

#ifdef __AVX512VNNI__
#define TACTNET_VNNI(name) name##_epi32
#else
#define TACTNET_VNNI(name) name##_avx_epi32
#endif

struct vnni : decltype(set_of(rank<3>{})) {
    static constexpr std::size_t word_product_cost = 1;

    template <std::size_t Lanes>
    struct words : group_products<Lanes, std::int16_t, std::int16_t> {
        [[gnu::always_inline]] static int32_vec<Lanes>
        add(const int32_vec<Lanes>& sums, const int32_vec<Lanes>& w, const int32_vec<Lanes>& x) {
            if constexpr (Lanes == 4)
                return (int32_vec<4>)TACTNET_VNNI(_mm_dpwssd)((__m128i)sums, (__m128i)w, (__m128i)x);
            else if constexpr (Lanes == 8)
                return (int32_vec<8>)TACTNET_VNNI(_mm256_dpwssd)((__m256i)sums, (__m256i)w, (__m256i)x);
            else
                return (int32_vec<16>)_mm512_dpwssd_epi32((__m512i)sums, (__m512i)w, (__m512i)x);
        }
    };
    template <std::size_t Lanes>
    struct bytes : group_products<Lanes, std::uint8_t, std::int8_t> {
        [[gnu::always_inline]] static int32_vec<Lanes>
        add(const int32_vec<Lanes>& sums, const int32_vec<Lanes>& w, const int32_vec<Lanes>& x) {
            if constexpr (Lanes == 4)
                return (int32_vec<4>)TACTNET_VNNI(_mm_dpbusd)((__m128i)sums, (__m128i)x, (__m128i)w);
            else if constexpr (Lanes == 8)
                return (int32_vec<8>)TACTNET_VNNI(_mm256_dpbusd)((__m256i)sums, (__m256i)x, (__m256i)w);
            else
                return (int32_vec<16>)_mm512_dpbusd_epi32((__m512i)sums, (__m512i)x, (__m512i)w);
        }
    };
};
vnni set_of(rank<4>);

#undef TACTNET_VNNI

}}}} // namespace tactnet::kernels::arch
#endif
