#pragma once

#include <tactnet/kernels/simd/float_lanes.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <cstddef>
#include <limits>

// exp of a vector, bit-identical with and without SIMD. x = n · ln 2 + r with an integer n and |r| ≤ ln 2 /
// 2; eʳ is a Taylor series whose first omitted term is below 2⁻²⁷, and n is added to the exponent's bits.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// Adding this number rounds to an integer, which is then in the lowest bits: so large a number has no
/// fraction.
inline constexpr float integer_shift = 0x1.8p23F;

/// values · 2ⁿ, where `shifted` is n + integer_shift. The result must be a normal number.
template <float_vector Vector>
[[nodiscard]] inline Vector times_power_of_two(const Vector& values, const Vector& shifted) {
    return from_bits<Vector>(to_bits(values) + (to_bits(shifted) << mantissa_bits));
}

} // namespace detail

/// eˣ with an error of at most 1.5 units in the last place. Below ln 2⁻¹²⁶ ≈ −87.34, where results would be
/// subnormal, the result is 0; above ln of the largest float ≈ 88.72 it is infinity; for NaN it is NaN.
template <float_vector Vector>
[[nodiscard]] inline Vector exponential(const Vector& x) {
    using v = Vector;
    constexpr float log2_e = 0x1.715476p0F;
    // ln 2 in two parts. n times the first is exact: its last nine bits are zero.
    constexpr float ln2_high = 0x1.63p-1F, ln2_low = -0x1.bd0106p-13F;
    constexpr float lowest = -0x1.5d589ep6F, highest = 0x1.62e42ep6F;

    const v shifted = fused_multiply_add(x, v(log2_e), v(detail::integer_shift));
    const v n = shifted - v(detail::integer_shift);
    const v r = fused_multiply_add(n, v(-ln2_low), fused_multiply_add(n, v(-ln2_high), x));
    v series(1.0F / 5040);
    for (const float factorial : {720.0F, 120.0F, 24.0F, 6.0F, 2.0F, 1.0F, 1.0F})
        series = fused_multiply_add(series, r, v(1 / factorial));
    const v result = detail::times_power_of_two(series, shifted);
    const v infinity(std::numeric_limits<float>::infinity());
    return choose_lanes(x < v(lowest), v(0.0F),
                        choose_lanes(x > v(highest), infinity, choose_lanes(x == x, result, x)));
}

/// values = exp(−factor · values) for values ≥ 0; `count` is a multiple of the lanes.
inline void negative_exponentials(float* values, std::size_t count, float factor) {
    const vector<float> f(-factor);
    for (std::size_t i = 0; i < count; i += lanes<float>)
        store(values + i, exponential(f * load(values + i)));
}

}}} // namespace tactnet::kernels
