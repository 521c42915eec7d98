#pragma once

#include <tactnet/kernels/arch/sse2.hpp>

#if !defined(TACTNET_NO_SIMD) && defined(__AVX2__)

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

// One instruction converts bytes to a whole register of wider integers. GCC 12 converts halves and joins
// them.
struct avx2 : sse2 {
    static constexpr std::size_t integer_lanes = 8;

    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static int16_vec<Lanes> to_int16(const uint8_vec<Lanes>& values) {
        if constexpr (Lanes == 16)
            return reinterpret_cast<int16_vec<Lanes>>(
                _mm256_cvtepu8_epi16(reinterpret_cast<__m128i>(values)));
        else
            return sse2::to_int16<Lanes>(values);
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static int32_vec<Lanes> to_int32(const uint8_vec<Lanes>& values) {
        if constexpr (Lanes == 8)
            return reinterpret_cast<int32_vec<Lanes>>(
                _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(&values))));
        else
            return __builtin_convertvector(to_int16<Lanes>(values), int32_vec<Lanes>);
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static uint8_vec<4 * Lanes>
    narrow(const std::array<int32_vec<Lanes>, 4>& whole) {
        if constexpr (Lanes == 8) {
            const auto lane = [&](std::size_t v) { return reinterpret_cast<__m256i>(whole[v]); };
            __m256i packed = _mm256_packus_epi16(_mm256_packs_epi32(lane(0), lane(1)),
                                                 _mm256_packs_epi32(lane(2), lane(3)));
            // GCC 12 takes the lower half of a packed vector for the packed lower half of the first operand;
            // it does not look through an empty instruction.
            asm("" : "+x"(packed));
            return reinterpret_cast<uint8_vec<4 * Lanes>>(packed);
        } else {
            return sse2::narrow<Lanes>(whole);
        }
    }
};
avx2 set_of(rank<2>);

}}}} // namespace tactnet::kernels::arch
#endif
