#pragma once

#include <tactnet/kernels/arch/neon.hpp>

#if !defined(TACTNET_NO_SIMD) && defined(TACTNET_DOTPROD)

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct dot_product : neon {
    template <std::size_t Lanes>
    struct bytes : group_products<Lanes, std::int8_t, std::int8_t> {
        static constexpr int offset = 128; // this instruction multiplies signed bytes only

        /// As bytes: of a load of integers, GCC 12 makes further moves.
        [[gnu::always_inline]] static int32_vec<Lanes> load(const std::int8_t* from) {
            return vreinterpretq_s32_s8(vld1q_s8(from));
        }
        [[gnu::always_inline]] static int32_vec<Lanes>
        add(const int32_vec<Lanes>& sums, const int32_vec<Lanes>& w, const int32_vec<Lanes>& x) {
#ifdef __ARM_FEATURE_DOTPROD
            return vdotq_s32(sums, vreinterpretq_s8_s32(w), vreinterpretq_s8_s32(x));
#else // Clang 14 has the instruction, but not its function
            int32_vec<Lanes> more = sums;
            asm("sdot %0.4s, %1.16b, %2.16b" : "+w"(more) : "w"(w), "w"(x));
            return more;
#endif
        }
    };
};
dot_product set_of(rank<2>);

}}}} // namespace tactnet::kernels::arch
#endif
