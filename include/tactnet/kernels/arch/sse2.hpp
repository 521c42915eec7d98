#pragma once

#include <tactnet/kernels/arch/scalar.hpp>

#if !defined(TACTNET_NO_SIMD) && defined(__SSE2__)
#include <immintrin.h>

// SSE2 to AVX: pairs of words.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct sse2 : scalar {
    static constexpr std::size_t integer_lanes = 4;
#ifdef __SSSE3__
    static constexpr bool shuffles_bytes = true;
#endif

    template <std::size_t Lanes>
    struct words : group_products<Lanes, std::int16_t, std::int16_t> {
        /// Two adjacent instructions: compilers, which may reorder products and sums, would compute all
        /// products first and keep the sums in memory. A sum keeps one type throughout, since compilers copy
        /// where types change.
        [[gnu::always_inline]] static int32_vec<Lanes> add(int32_vec<Lanes> sums, const int32_vec<Lanes>& w,
                                                           const int32_vec<Lanes>& x) {
            int32_vec<Lanes> product;
#if defined(__AVX512F__)
            asm("vpmaddwd %3, %2, %1\n\tvpaddd %1, %0, %0" : "+v"(sums), "=&v"(product) : "v"(w), "v"(x));
#elif defined(__AVX__)
            asm("vpmaddwd %3, %2, %1\n\tvpaddd %1, %0, %0" : "+x"(sums), "=&x"(product) : "x"(w), "x"(x));
#else
            asm("movdqa %2, %1\n\tpmaddwd %3, %1\n\tpaddd %1, %0"
                : "+x"(sums), "=&x"(product)
                : "x"(w), "x"(x));
#endif
            return sums;
        }
    };
    template <std::size_t Lanes>
    using bytes = words<Lanes>;

    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static uint8_vec<4 * Lanes>
    narrow(const std::array<int32_vec<Lanes>, 4>& whole) {
        static_assert(Lanes == 4);
        const auto lane = [&](std::size_t v) { return reinterpret_cast<__m128i>(whole[v]); };
        return reinterpret_cast<uint8_vec<16>>(
            _mm_packus_epi16(_mm_packs_epi32(lane(0), lane(1)), _mm_packs_epi32(lane(2), lane(3))));
    }
};
sse2 set_of(rank<1>);

}}}} // namespace tactnet::kernels::arch
#endif
