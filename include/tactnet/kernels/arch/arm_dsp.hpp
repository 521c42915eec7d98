#pragma once

#include <tactnet/kernels/arch/scalar.hpp>

#if defined(__arm__) && defined(__ARM_FEATURE_SIMD32) && !defined(__ARM_BIG_ENDIAN)
#include <arm_acle.h>

// Pairs of words in general registers: Cortex-M4 and M7, and 32-bit ARM since version 6.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct arm_dsp : scalar {
    /// Registers are so few that each weight is loaded and widened once, and inputs for each product.
    static constexpr bool weight_by_weight = true;

    template <std::size_t Lanes>
    struct words {
        using staged = std::int16_t;
        using weight = std::int16_t;
        using weights = int16x2_t;
        using inputs = int16x2_t;
        static constexpr std::size_t group = 2;
        static constexpr int offset = 0;
        static constexpr std::size_t max_sums = 4; // of 14 registers

        [[gnu::always_inline]] static weights load(const std::int16_t* from) {
            return load_bytes_as<weights>(aligned<4>(from));
        }
        [[gnu::always_inline]] static inputs broadcast(const staged* from) {
            return load_bytes_as<inputs>(from);
        }
        [[gnu::always_inline]] static int32_vec<Lanes> add(const int32_vec<Lanes>& sums, const weights& w,
                                                           const inputs& x) {
            return int32_vec<Lanes>{__smlad(w, x, sums[0])};
        }
    };

    /// Weights are bytes in memory and pairs of words in registers. One instruction widens the even bytes of
    /// a register, another the odd bytes, hence the order.
    template <std::size_t Lanes>
    struct bytes {
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
        static constexpr std::size_t max_sums = words<Lanes>::max_sums;

        [[gnu::always_inline]] static weights load(const std::int8_t* from) {
            using four [[gnu::may_alias]] = int8x4_t;
            const int8x4_t bytes_of_group = *reinterpret_cast<const volatile four*>(from);
            int16x2_t second;
            // __sxtb16 of the bytes turned by 8 would be two instructions.
            asm("sxtb16 %0, %1, ror #8" : "=r"(second) : "r"(bytes_of_group));
            return {__sxtb16(bytes_of_group), second};
        }
        [[gnu::always_inline]] static inputs broadcast(const staged* from) {
            // Volatile for one instruction: GCC would load halves, early, and store them on the stack.
            using both_pairs [[gnu::may_alias, gnu::aligned(4)]] = std::uint64_t;
            const std::uint64_t both = *reinterpret_cast<const volatile both_pairs*>(from);
            return {static_cast<int16x2_t>(both), static_cast<int16x2_t>(both >> 32)};
        }
        [[gnu::always_inline]] static int32_vec<Lanes> add(const int32_vec<Lanes>& sums, const weights& w,
                                                           const inputs& x) {
            return int32_vec<Lanes>{__smlad(w.second, x.second, __smlad(w.first, x.first, sums[0]))};
        }
    };
};
arm_dsp set_of(rank<1>);

}}}} // namespace tactnet::kernels::arch
#endif
