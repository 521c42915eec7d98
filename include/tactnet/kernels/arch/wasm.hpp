#pragma once

#include <tactnet/kernels/arch/scalar.hpp>

#if !defined(TACTNET_NO_SIMD) && defined(__wasm_simd128__)
#include <wasm_simd128.h>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

struct wasm : scalar {
    static constexpr std::size_t integer_lanes = 4;

    template <std::size_t Lanes>
    struct words : group_products<Lanes, std::int16_t, std::int16_t> {
        [[gnu::always_inline]] static int32_vec<Lanes>
        add(const int32_vec<Lanes>& sums, const int32_vec<Lanes>& w, const int32_vec<Lanes>& x) {
            return sums + (int32_vec<Lanes>)wasm_i32x4_dot_i16x8((v128_t)w, (v128_t)x);
        }
    };
    template <std::size_t Lanes>
    using bytes = words<Lanes>;
};
wasm set_of(rank<1>);

}}}} // namespace tactnet::kernels::arch
#endif
