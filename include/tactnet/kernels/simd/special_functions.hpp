#pragma once

#include <tactnet/detail/special_functions.hpp>
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

// Functions of activations, of a vector of floats of any width or of one double: one template of an
// activation serves both. In single precision the polynomials were fitted in 40 digits, and multiply-adds are
// few, since these decide the time. The bits of a result do not depend on the width of the vector, and on the
// instruction set only in whether it fuses multiply-adds.

using tactnet::detail::exponential;
using tactnet::detail::hyperbolic_tangent;
using tactnet::detail::log_one_plus;
using tactnet::detail::normal_density;
using tactnet::detail::normal_tail;

namespace detail {

/// A polynomial by Horner's rule, highest power first.
template <float_vector Vector, std::size_t Count>
[[nodiscard]] [[gnu::always_inline]] inline Vector polynomial(const Vector& x,
                                                              const float (&coefficients)[Count]) {
    Vector sum(coefficients[0]);
#pragma GCC unroll 16
    for (std::size_t i = 1; i < Count; ++i)
        sum = fused_multiply_add(sum, x, Vector(coefficients[i]));
    return sum;
}

/// x = n · ln 2 + r with an integer n, for |x| < 88.7, and the power 2ⁿ; 0 for n = −127, infinite for 128.
template <float_vector Vector>
struct reduced_exponent {
    Vector r, power;

    [[gnu::always_inline]] explicit reduced_exponent(const Vector& x) {
        constexpr float log2_e = 0x1.715476p0F, ln2_high = 0x1.63p-1F, ln2_low = -0x1.bd0106p-13F;
        const Vector shifted = fused_multiply_add(x, Vector(log2_e), Vector(biased_integer_shift));
        const Vector n = shifted - Vector(biased_integer_shift);
        r = fused_multiply_add(n, Vector(-ln2_low), fused_multiply_add(n, Vector(-ln2_high), x));
        power = power_of_two(shifted);
    }
};

/// eʳ for |r| ≤ ln 2 ÷ 2, off by less than 2·10⁻⁹ before rounding.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector exponential_near_zero(const Vector& r) {
    return polynomial(
        r, {0x1.6ab8cep-10F, 0x1.126dbep-7F, 0x1.55589ep-5F, 0x1.55540ap-3F, 0x1.fffffap-2F, 1.0F, 1.0F});
}

} // namespace detail

/// eˣ for x ≤ 0, within 1.5 units in the last place of results that are normal numbers; 0 below −87.7. For
/// NaN it is NaN.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector exponential_of_negative(const Vector& x) {
    constexpr float lowest = -88; // its power is 0
    const detail::reduced_exponent reduced(at_least(Vector(lowest), x));
    return reduced.power * detail::exponential_near_zero(reduced.r);
}
/// In double precision.
[[nodiscard]] constexpr double exponential_of_negative(double x) {
    return tactnet::detail::exponential(x);
}

/// 1 + e⁻ˣ, within 2 units in the last place; infinite below −88.4.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector one_plus_exponential_of_opposite(const Vector& x) {
    constexpr float least = -88, most = 88.6F; // their powers are 0 and infinite
    const detail::reduced_exponent reduced(at_least(Vector(least), at_most(Vector(most), Vector(0.0F) - x)));
    return fused_multiply_add(reduced.power, detail::exponential_near_zero(reduced.r), Vector(1.0F));
}
/// In double precision.
[[nodiscard]] constexpr double one_plus_exponential_of_opposite(double x) {
    return 1 + tactnet::detail::exponential(-x);
}

namespace detail {

/// eˣ for x ≤ 0 as 2ⁿ · (eʳ − 1) + 2ⁿ.
template <float_vector Vector>
struct exponential_parts {
    Vector power, less_one;

    [[gnu::always_inline]] explicit exponential_parts(const Vector& x) {
        constexpr float lowest = -87;
        const reduced_exponent reduced(at_least(Vector(lowest), x));
        const Vector& r = reduced.r;
        power = reduced.power;
        less_one = fused_multiply_add(r * r,
                                      polynomial(r, {0x1.a2a44ap-13F, 0x1.6d83f6p-10F, 0x1.11101cp-7F,
                                                     0x1.55549ep-5F, 0x1.555556p-3F, 0.5F}),
                                      r);
    }
    /// eˣ + term for 1 or −1, rounded once from the parts.
    [[nodiscard]] [[gnu::always_inline]] Vector plus(float term) const {
        return fused_multiply_add(power, less_one, power + Vector(term));
    }
};

} // namespace detail

/// eˣ − 1 for x ≤ 0, within 2 units in the last place. For NaN it is NaN.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector exponential_minus_one(const Vector& x) {
    return detail::exponential_parts(x).plus(-1);
}
/// In double precision. Returns 0 for NaN and above 0, where elu_function takes x.
[[nodiscard]] constexpr double exponential_minus_one(double x) {
    const double t = hyperbolic_tangent(x < 0 ? 0.5 * x : 0);
    return 2 * t / (1 - t);
}

/// tanh x, within 2 units in the last place: (p − 1) ÷ (p + 1) with the sign of x, where p is e to the power
/// of −2 |x|. Both are rounded once, from the parts of p − 1.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector hyperbolic_tangent(const Vector& x) {
    const Vector less = negative_magnitude(x);
    const detail::exponential_parts p(less + less);
    return with_sign_of(x, quotient(p.plus(-1), p.plus(1)));
}

/// log(1 + x) for 0 ≤ x ≤ 1, within 2 units in the last place: 2 artanh(x ÷ (2 + x)).
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector log_one_plus(const Vector& x) {
    const Vector s = quotient<Vector>(x, x + Vector(2.0F)), square = s * s;
    const Vector series = detail::polynomial(
        square, {0x1.dba26p-3F, 0x1.bc8cf8p-3F, 0x1.24c926p-2F, 0x1.9998d4p-2F, 0x1.555556p-1F});
    return fused_multiply_add(s * square, series, s + s);
}

namespace detail {

/// Where exp(−x²/2) = 2ⁿ · … has n = −127.
inline constexpr float end_of_bell = 13.27F;

/// exp(−x²/2) for 0 ≤ x ≤ end_of_bell; 0 above 13.25. The square of x rounded to a multiple of 2⁻⁷ is exact;
/// rounding the whole square would cost digits of the result. x² = −2 n · ln 2 + q, and the polynomial is
/// that of exp(−q/2).
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector bell(const Vector& x) {
    constexpr float rounds_to_multiples = 0x1.8p16F, half_log2_e = 0x1.715476p-1F;
    constexpr float twice_ln2_high = 0x1.63p0F, twice_ln2_low = -0x1.bd0106p-12F;
    const Vector first = (x + Vector(rounds_to_multiples)) - Vector(rounds_to_multiples);
    const Vector square = first * first;
    const Vector shifted = fused_multiply_add(square, Vector(-half_log2_e), Vector(biased_integer_shift));
    const Vector n = shifted - Vector(biased_integer_shift);
    const Vector of_first =
        fused_multiply_add(n, Vector(twice_ln2_low), fused_multiply_add(n, Vector(twice_ln2_high), square));
    const Vector q = fused_multiply_add(x - first, x + first, of_first);
    return power_of_two(shifted) * polynomial(q, {0x1.725fe8p-16F, -0x1.1324e6p-12F, 0x1.554daep-9F,
                                                  -0x1.55524ap-6F, 0x1.000004p-3F, -0x1.000002p-1F, 1.0F});
}

} // namespace detail

/// The density of the standard normal distribution at x, within 4 units in the last place; 0 beyond 13.3.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector normal_density(const Vector& x) {
    constexpr float of_zero = 0.3989422804F;
    return Vector(of_zero) * detail::bell(at_most(Vector(detail::end_of_bell), magnitude(x)));
}

/// The probability that a standard normal variable is below −x, for x ≥ 0: exp(−x²/2) times a quotient of
/// polynomials with positive coefficients. Within 8 units in the last place; 0 from 13.3 on.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector normal_tail(const Vector& x) {
    const Vector within = at_most(Vector(detail::end_of_bell), x);
    const Vector above =
        detail::polynomial(within, {0x1.06f378p-8F, 0x1.4726bep-5F, 0x1.7308a4p-3F, 0x1.bdf672p-2F, 0.5F});
    const Vector below = detail::polynomial(
        within, {0x1.498e3ap-7F, 0x1.9a0dc2p-4F, 0x1.db268ep-2F, 0x1.31a542p0F, 0x1.ab3d68p0F, 1.0F});
    return quotient<Vector>(detail::bell(within) * above, below);
}

}}} // namespace tactnet::kernels
