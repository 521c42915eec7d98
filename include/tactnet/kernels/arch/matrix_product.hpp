#pragma once

#include <tactnet/kernels/arch/dot_product.hpp>

#if !defined(TACTNET_NO_SIMD) && defined(TACTNET_DOTPROD) && defined(__ARM_FEATURE_MATMUL_INT8)

// Armv8.6: one instruction multiplies eight inputs of two pixels by eight weights of two filters each.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct matrix_product : dot_product {
    /// Products for two neighbouring pixels and four filters: `add` has the sums of a pair of pixels, which
    /// `exchange` makes of those of each pixel, and these of those.
    struct pairs {
        using staged = std::uint8_t;
        using weight = std::int8_t;
        struct weights {
            int8x16_t first, second; ///< filters 0 and 1, 2 and 3
        };
        using inputs = uint8x16_t;
        static constexpr std::size_t group = 8;
        static constexpr int offset = 0;

        [[gnu::always_inline]] static weights load(const weight* from) {
            return {vld1q_s8(from), vld1q_s8(from + 16)};
        }
        /// Of the second pixel those at `distance` from the first.
        [[gnu::always_inline]] static inputs load_pair(const staged* from, std::size_t distance) {
            return distance == group ? vld1q_u8(from) : vcombine_u8(vld1_u8(from), vld1_u8(from + distance));
        }
        [[gnu::always_inline]] static void add(int32_vec<4>& first, int32_vec<4>& second, const weights& w,
                                               const inputs& x) {
            first = vusmmlaq_s32(first, x, w.first);
            second = vusmmlaq_s32(second, x, w.second);
        }
        [[gnu::always_inline]] static void exchange(int32_vec<4>& first, int32_vec<4>& second) {
            const auto low = vzip1q_s64(vreinterpretq_s64_s32(first), vreinterpretq_s64_s32(second)),
                       high = vzip2q_s64(vreinterpretq_s64_s32(first), vreinterpretq_s64_s32(second));
            first = vreinterpretq_s32_s64(low), second = vreinterpretq_s32_s64(high);
        }
    };
};
matrix_product set_of(rank<3>);

}}}} // namespace tactnet::kernels::arch
#endif
