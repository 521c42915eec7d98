#pragma once

#include <tactnet/kernels/arch/avx2.hpp>

#if !defined(TACTNET_NO_SIMD) && defined(__AVX512BW__)

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct avx512 : avx2 {
    static constexpr std::size_t integer_lanes = 16;
#ifdef __AVX512VL__
    static constexpr bool shuffles_bytes = false;
#endif

    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static int16_vec<Lanes> to_int16(const uint8_vec<Lanes>& values) {
        if constexpr (Lanes == 32)
            return reinterpret_cast<int16_vec<Lanes>>(
                _mm512_cvtepu8_epi16(reinterpret_cast<__m256i>(values)));
        else
            return avx2::to_int16<Lanes>(values);
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static int32_vec<Lanes> to_int32(const uint8_vec<Lanes>& values) {
        if constexpr (Lanes == 16) // without a mask, GCC 12 warns about its own header
            return reinterpret_cast<int32_vec<Lanes>>(
                _mm512_maskz_cvtepu8_epi32(0xFFFF, reinterpret_cast<__m128i>(values)));
        else
            return avx2::to_int32<Lanes>(values);
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static uint8_vec<4 * Lanes>
    narrow(const std::array<int32_vec<Lanes>, 4>& whole) {
        if constexpr (Lanes == 16) {
            const auto lane = [&](std::size_t v) { return reinterpret_cast<__m512i>(whole[v]); };
            __m512i packed = _mm512_packus_epi16(_mm512_packs_epi32(lane(0), lane(1)),
                                                 _mm512_packs_epi32(lane(2), lane(3)));
            asm("" : "+v"(packed)); // as in AVX2
            return reinterpret_cast<uint8_vec<4 * Lanes>>(packed);
        } else {
            return avx2::narrow<Lanes>(whole);
        }
    }
};
avx512 set_of(rank<3>);

}}}} // namespace tactnet::kernels::arch
#endif
