#pragma once

#include <tactnet/kernels/arch/scalar.hpp>

#if !defined(TACTNET_NO_SIMD) && defined(__aarch64__)
#include <arm_neon.h>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct neon : scalar {
    static constexpr std::size_t integer_lanes = 4;
    static constexpr bool shuffles_bytes = true;

    template <std::size_t>
    struct words {
        using staged = std::int16_t;
        using weight = std::int16_t;
        using weights = int16x4_t;
        using inputs = std::int16_t;
        static constexpr std::size_t group = 1;
        static constexpr int offset = 0;

        [[gnu::always_inline]] static weights load(const std::int16_t* from) { return vld1_s16(from); }
        [[gnu::always_inline]] static inputs broadcast(const staged* from) { return *from; }
        /// Keeps the sum at its place in the order of the program.
        [[gnu::always_inline]] static int32_vec<4> add(const int32_vec<4>& sums, const weights& w,
                                                       const inputs& x) {
            auto sum = vmlal_n_s16(sums, w, x);
            asm("" : "+w"(sum));
            return sum;
        }
    };
    template <std::size_t Lanes>
    using bytes = words<Lanes>;
};
neon set_of(rank<1>);

}}}} // namespace tactnet::kernels::arch
#endif
