#pragma once

#include <tactnet/kernels/arch/scalar.hpp>

#if defined(TACTNET_HELIUM)
#include <arm_mve.h>

// Helium, the vectors of Cortex-M55 and M85: one instruction adds the products of 16 bytes or 8 words to one
// sum in a general register.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct helium : scalar {
    static constexpr std::size_t vector_registers = 8, float_lanes = 4, rounded_lanes = 4;

    /// Rounded once; one number for all lanes is in a general register.
    [[nodiscard]] [[gnu::always_inline]] static float_vec<4>
    multiply_add(const float_vec<4>& a, const float_vec<4>& b, const float_vec<4>& c) {
        return vfmaq_f32(c, a, b);
    }
    [[nodiscard]] [[gnu::always_inline]] static float_vec<4> multiply_add(const float_vec<4>& a, float b,
                                                                          const float_vec<4>& c) {
        return vfmaq_n_f32(c, a, b);
    }
    using scalar::larger;
    [[nodiscard]] [[gnu::always_inline]] static float_vec<4> larger(const float_vec<4>& a,
                                                                    const float_vec<4>& b) {
        return vpselq_f32(a, b, vcmpgtq_f32(a, b));
    }

    // GCC 12 converts, compares and narrows lane by lane.
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static float_vec<Lanes> to_float(const int32_vec<Lanes>& values) {
        if constexpr (Lanes == 4)
            return vcvtq_f32_s32((int32x4_t)values);
        else
            return scalar::to_float<Lanes>(values);
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static float_vec<Lanes> clamp(const float_vec<Lanes>& values,
                                                                       float lowest, float highest) {
        if constexpr (Lanes == 4)
            return vminnmq_f32(vmaxnmq_f32(values, vdupq_n_f32(lowest)), vdupq_n_f32(highest));
        else
            return scalar::clamp<Lanes>(values, lowest, highest);
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static uint8_vec<Lanes> last_bytes(const int32_vec<Lanes>& whole) {
        if constexpr (Lanes == 4) {
            uint8_vec<Lanes> bytes;
            vstrbq_s32(reinterpret_cast<std::int8_t*>(&bytes), (int32x4_t)whole);
            return bytes;
        } else {
            return scalar::last_bytes<Lanes>(whole);
        }
    }

    template <std::size_t>
    struct words {
        using staged = std::int16_t;
        using weight = std::int16_t;
        using weights = int16x8_t;
        using inputs = int16x8_t;
        static constexpr std::size_t group = 8;
        static constexpr int offset = 0;
        static constexpr std::size_t max_sums = 4; // in even registers

        [[gnu::always_inline]] static weights load(const weight* from) { return vld1q_s16(from); }
        [[gnu::always_inline]] static inputs broadcast(const staged* from) { return vld1q_s16(from); }
        [[gnu::always_inline]] static int32_vec<1> add(const int32_vec<1>& sums, const weights& w,
                                                       const inputs& x) {
            return int32_vec<1>{vmladavaq_s16(sums[0], w, x)};
        }
    };
    template <std::size_t>
    struct bytes {
        using staged = std::int8_t;
        using weight = std::int8_t;
        using weights = int8x16_t;
        using inputs = int8x16_t;
        static constexpr std::size_t group = 16;
        static constexpr int offset = 128; // signed bytes only
        static constexpr std::size_t max_sums = 4;

        [[gnu::always_inline]] static weights load(const weight* from) { return vld1q_s8(from); }
        [[gnu::always_inline]] static inputs broadcast(const staged* from) { return vld1q_s8(from); }
        [[gnu::always_inline]] static int32_vec<1> add(const int32_vec<1>& sums, const weights& w,
                                                       const inputs& x) {
            return int32_vec<1>{vmladavaq_s8(sums[0], w, x)};
        }
    };
};
helium set_of(rank<2>);

}}}} // namespace tactnet::kernels::arch
#endif
