#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/compiler_vector.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// The operations of activation functions: on a vector of floats of any width, on several vectors side by
// side, or on one double. Most take one instruction.

#if !defined(TACTNET_NO_SIMD) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push // as in xsimd.hpp
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

#ifndef TACTNET_NO_SIMD

/// A vector of floats: sized_vector<float, N> of any N.
template <class Vector>
concept float_vector =
    std::same_as<typename Vector::value_type, float> && requires { typename Vector::batch_bool_type; };

namespace detail {

/// The bits of a vector, as one of the compiler's.
template <float_vector Vector>
using bits_of_lanes = uint32_vec<Vector::size>;
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline bits_of_lanes<Vector> to_bits(const Vector& x) {
    return (bits_of_lanes<Vector>)x.data;
}
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector from_bits(const bits_of_lanes<Vector>& bits) {
    return Vector((float_vec<Vector::size>)bits);
}
inline constexpr std::uint32_t sign_bit = 0x80000000U;

} // namespace detail

/// `yes` where the condition holds, otherwise `no`.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector
choose_lanes(const typename Vector::batch_bool_type& condition, const Vector& yes, const Vector& no) {
    return xsimd::select(condition, yes, no);
}
/// The larger of a limit, which is a number, and x, and x if they are equal; NaN stays NaN. One instruction;
/// that of ARM returns +0 for zeros of opposite signs.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector at_least(const Vector& limit, const Vector& x) {
#if defined(__SSE2__) || defined(__wasm_simd128__)
    return Vector(detail::larger(limit.data, x.data));
#else // NaN if either is, whatever their order
    return xsimd::max(limit, x);
#endif
}
/// The smaller of a limit, which is a number, and x, and x if they are equal; NaN stays NaN. One instruction;
/// that of ARM returns −0 for zeros of opposite signs.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector at_most(const Vector& limit, const Vector& x) {
#if defined(__SSE2__) || defined(__wasm_simd128__)
    return Vector(detail::smaller(limit.data, x.data));
#else
    return xsimd::min(limit, x);
#endif
}
/// |x|.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector magnitude(const Vector& x) {
    return detail::from_bits<Vector>(detail::to_bits(x) & ~detail::sign_bit);
}
/// −|x|.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector negative_magnitude(const Vector& x) {
    return detail::from_bits<Vector>(detail::to_bits(x) | detail::sign_bit);
}
/// |value| with the sign of x.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector with_sign_of(const Vector& x, const Vector& value) {
    return detail::from_bits<Vector>((detail::to_bits(x) & detail::sign_bit) |
                                     (detail::to_bits(value) & ~detail::sign_bit));
}
/// a · b + c, rounded once if the instruction set can.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector product_plus(const Vector& a, const Vector& b,
                                                                const Vector& c) {
    return fused_multiply_add(a, b, c);
}

#else

template <class Vector>
concept float_vector = std::same_as<Vector, vector<float>>;

namespace detail {

using bits_of_lanes = std::conditional_t<lanes<float> == 1, std::uint32_t, uint32_vec<lanes<float>>>;
[[nodiscard]] inline bits_of_lanes to_bits(const vector<float>& x) {
    return tactnet::detail::bits_as<bits_of_lanes>(x.data);
}
template <float_vector Vector>
[[nodiscard]] inline Vector from_bits(const bits_of_lanes& bits) {
    return Vector(tactnet::detail::bits_as<typename Vector::register_type>(bits));
}
inline constexpr std::uint32_t sign_bit = 0x80000000U;

} // namespace detail

[[nodiscard]] inline vector<float> choose_lanes(const mask<float>& condition, const vector<float>& yes,
                                                const vector<float>& no) {
    return choose<float>(condition, yes, no);
}
[[nodiscard]] inline vector<float> at_least(const vector<float>& limit, const vector<float>& x) {
    return maximum_or_second(limit, x);
}
[[nodiscard]] inline vector<float> at_most(const vector<float>& limit, const vector<float>& x) {
    return choose<float>(limit < x, limit, x);
}
[[nodiscard]] inline vector<float> magnitude(const vector<float>& x) {
    return detail::from_bits<vector<float>>(detail::to_bits(x) & ~detail::sign_bit);
}
[[nodiscard]] inline vector<float> negative_magnitude(const vector<float>& x) {
    return detail::from_bits<vector<float>>(detail::to_bits(x) | detail::sign_bit);
}
[[nodiscard]] inline vector<float> with_sign_of(const vector<float>& x, const vector<float>& value) {
    return detail::from_bits<vector<float>>((detail::to_bits(x) & detail::sign_bit) |
                                            (detail::to_bits(value) & ~detail::sign_bit));
}
[[nodiscard]] inline vector<float> product_plus(const vector<float>& a, const vector<float>& b,
                                                const vector<float>& c) {
    return fused_multiply_add(a, b, c);
}

#endif

namespace detail {

inline constexpr int mantissa_bits = 23;
/// Adding this number rounds to an integer n; the lowest bits then hold n + 127, the exponent of 2ⁿ.
inline constexpr float biased_integer_shift = 0x1.8p23F + 127;

/// 2ⁿ, where `shifted` is n + biased_integer_shift, for −126 ≤ n ≤ 127; 0 for n = −127, infinite for 128.
template <float_vector Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector power_of_two(const Vector& shifted) {
    return from_bits<Vector>(to_bits(shifted) << mantissa_bits);
}

} // namespace detail

// In double precision.
[[nodiscard]] constexpr double choose_lanes(bool condition, double yes, double no) {
    return condition ? yes : no;
}
[[nodiscard]] constexpr double at_least(double limit, double x) {
    return limit > x ? limit : x;
}
[[nodiscard]] constexpr double at_most(double limit, double x) {
    return limit < x ? limit : x;
}
[[nodiscard]] constexpr double magnitude(double x) {
    return x < 0 ? -x : x;
}
[[nodiscard]] constexpr double negative_magnitude(double x) {
    return x < 0 ? x : -x;
}
[[nodiscard]] constexpr double product_plus(double a, double b, double c) {
    return a * b + c;
}

}}} // namespace tactnet::kernels

#if !defined(TACTNET_NO_SIMD) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
