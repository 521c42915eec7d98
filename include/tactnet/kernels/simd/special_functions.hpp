#pragma once

#include <tactnet/detail/special_functions.hpp>
#include <tactnet/kernels/simd/exponential.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <cstddef>

// Functions of activations, of a vector of floats or of one double. `choose_lanes` lets one function template
// serve both. In single precision the polynomials were fitted in 40 digits on Chebyshev nodes; the bit
// pattern of a result does not depend on the instruction set.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

using tactnet::detail::exponential;
using tactnet::detail::hyperbolic_tangent;
using tactnet::detail::log_one_plus;
using tactnet::detail::normal_density;
using tactnet::detail::normal_tail;

/// `yes` where the condition holds, otherwise `no`.
[[nodiscard]] inline vector<float> choose_lanes(const mask<float>& condition, const vector<float>& yes,
                                                const vector<float>& no) {
    return choose<float>(condition, yes, no);
}
[[nodiscard]] constexpr double choose_lanes(bool condition, double yes, double no) {
    return condition ? yes : no;
}
/// |x|; NaN stays NaN.
template <class Number>
[[nodiscard]] constexpr Number magnitude(const Number& x) {
    return choose_lanes(x < Number(0), Number(0) - x, x);
}

namespace detail {

/// A polynomial by Horner's rule, highest power first.
template <std::size_t Count>
[[nodiscard]] inline vector<float> polynomial(const vector<float>& x, const float (&coefficients)[Count]) {
    vector<float> sum(coefficients[0]);
    for (std::size_t i = 1; i < Count; ++i)
        sum = multiply_add(sum, x, vector<float>(coefficients[i]));
    return sum;
}

} // namespace detail

/// tanh x, within 2 units in the last place.
[[nodiscard]] inline vector<float> hyperbolic_tangent(const vector<float>& x) {
    using v = vector<float>;
    const v size = magnitude(x), square = x * x;
    // x + x³ · P(x²) below 0.625; the difference of 1 and a small quotient above it.
    const v series = detail::polynomial(
        square, {-0x1.8f8de4p-8F, 0x1.58048ep-6F, -0x1.b9258ap-5F, 0x1.110e1cp-3F, -0x1.555552p-2F});
    const v near_zero = multiply_add(x * square, series, x);
    const v far = v(1) - v(2) / (exponential(size + size) + v(1));
    return choose<float>(size < v(0.625F), near_zero, choose<float>(x < v(0), v(0) - far, far));
}

/// eˣ − 1 for x ≤ 0, within 2 units in the last place: 2ⁿ · (eʳ − 1) + (2ⁿ − 1), with n and r as of
/// `exponential`. For NaN it is NaN.
[[nodiscard]] inline vector<float> exponential_minus_one(const vector<float>& x) {
    using v = vector<float>;
    constexpr float log2_e = 0x1.715476p0F, ln2_high = 0x1.63p-1F, ln2_low = -0x1.bd0106p-13F;
    const v within = choose<float>(x < v(-87.0F), v(-87.0F), x);
    const v shifted = multiply_add(within, v(log2_e), v(detail::integer_shift));
    const v n = shifted - v(detail::integer_shift);
    const v r = multiply_add(n, v(-ln2_low), multiply_add(n, v(-ln2_high), within));
    const v series =
        detail::polynomial(r, {1 / 40320.0F, 1 / 5040.0F, 1 / 720.0F, 1 / 120.0F, 1 / 24.0F, 1 / 6.0F, 0.5F});
    const v power = detail::times_power_of_two(v(1.0F), shifted);
    return multiply_add(power, multiply_add(r * r, series, r), power - v(1.0F));
}
/// In double precision. Returns 0 for NaN and above 0, where elu_function takes x.
[[nodiscard]] constexpr double exponential_minus_one(double x) {
    const double t = hyperbolic_tangent(x < 0 ? 0.5 * x : 0);
    return 2 * t / (1 - t);
}

/// log(1 + x) for 0 ≤ x ≤ 1, within 2 units in the last place: 2 artanh(x ÷ (2 + x)).
[[nodiscard]] inline vector<float> log_one_plus(const vector<float>& x) {
    using v = vector<float>;
    const v s = x / (x + v(2)), square = s * s;
    const v series = detail::polynomial(
        square, {0x1.dba26p-3F, 0x1.bc8cf8p-3F, 0x1.24c926p-2F, 0x1.9998d4p-2F, 0x1.555556p-1F});
    return multiply_add(s * square, series, s + s);
}

namespace detail {

/// exp(−x²/2). The square of x rounded to a multiple of 2⁻⁷ is exact; rounding the whole square would cost
/// digits of the result.
[[nodiscard]] inline vector<float> bell(const vector<float>& x) {
    using v = vector<float>;
    constexpr float rounds_to_multiples = 0x1.8p16F;
    const v within = choose<float>(magnitude(x) > v(20), v(20), x);
    const v first = (within + v(rounds_to_multiples)) - v(rounds_to_multiples), rest = within - first;
    return exponential(v(-0.5F) * first * first) * exponential(v(-0.5F) * rest * (within + first));
}

} // namespace detail

/// The density of the standard normal distribution at x, within 4 units in the last place; 0 beyond 13.2.
[[nodiscard]] inline vector<float> normal_density(const vector<float>& x) {
    constexpr float of_zero = 0.3989422804F;
    return vector<float>(of_zero) * detail::bell(x);
}

/// The probability that a standard normal variable is below −x, for x ≥ 0: exp(−x²/2) · M(x), where M is a
/// polynomial in 3.5 ÷ (3.5 + x). Within 8 units in the last place; 0 from 13.3 on.
[[nodiscard]] inline vector<float> normal_tail(const vector<float>& x) {
    using v = vector<float>;
    const v t = v(3.5F) / (x + v(3.5F));
    const v ratio = t * detail::polynomial(t, {-0x1.3018f6p-6F, 0x1.dd0a48p-4F, -0x1.1f72f2p-2F,
                                               0x1.36fc16p-2F, -0x1.537d0cp-3F, 0x1.2cab4ep-3F, 0x1.f724dp-5F,
                                               0x1.bef10cp-4F, 0x1.d101acp-4F, 0x1.d2f5c4p-4F});
    return detail::bell(x) * ratio;
}

}}} // namespace tactnet::kernels
