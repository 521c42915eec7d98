#pragma once

#include <tactnet/detail/config.hpp>

#include <cmath>
#include <concepts>

#ifndef TACTNET_NO_SIMD
// GCC 12 warns about its own AVX-512 intrinsics, which start from an undefined register on purpose (its bug
// 105593), even in system headers, since it looks at the place where they are inlined. One place on the way
// that ignores the warning is enough.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <xsimd/xsimd.hpp>
#if XSIMD_VERSION_MAJOR < 8 || (XSIMD_VERSION_MAJOR == 8 && XSIMD_VERSION_MINOR < 1)
#error "tactnet needs xsimd 8.1 or newer; without vector instructions, define TACTNET_NO_SIMD"
#endif
#if defined(__wasm_simd128__) &&                                                                             \
    (XSIMD_VERSION_MAJOR < 11 || (XSIMD_VERSION_MAJOR == 11 && XSIMD_VERSION_MINOR < 2))
#error "tactnet needs xsimd 11.2 or newer for WebAssembly, or TACTNET_NO_SIMD defined"
#endif
#endif

// xsimd, and what it does in its own way: the fused multiply-add, which old versions lack; the larger and the
// smaller of two numbers, whose operands version 14.2 exchanged; quotients and square roots of floats, which
// on ARM come of estimates.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// a · b + c, rounded once if the instruction set can, at any optimisation level.
template <std::floating_point T>
[[nodiscard]] inline T fused_multiply_add(const T& a, const T& b, const T& c) {
#if defined(__arm__) && defined(__ARM_FEATURE_FMA) && defined(__clang__)
    // Of std::fma, which may set errno, Clang makes a call.
    if constexpr (sizeof(T) == sizeof(float)) {
        T sum = c;
        asm("vfma.f32 %0, %1, %2" : "+t"(sum) : "t"(a), "t"(b));
        return sum;
    }
#endif
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
    return std::fma(a, b, c);
#else
    return a * b + c;
#endif
}

#ifndef TACTNET_NO_SIMD

namespace detail {
#ifdef __FMA__
// The processor's instruction for each register. xsimd 8 lacks it for some: whether a product is rounded
// would then depend on the compiler and the optimisation level.
[[nodiscard]] [[gnu::always_inline]] inline __m128 fmadd(__m128 a, __m128 b, __m128 c) {
    return _mm_fmadd_ps(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m128d fmadd(__m128d a, __m128d b, __m128d c) {
    return _mm_fmadd_pd(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m256 fmadd(__m256 a, __m256 b, __m256 c) {
    return _mm256_fmadd_ps(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m256d fmadd(__m256d a, __m256d b, __m256d c) {
    return _mm256_fmadd_pd(a, b, c);
}
#ifdef __AVX512F__
[[nodiscard]] [[gnu::always_inline]] inline __m512 fmadd(__m512 a, __m512 b, __m512 c) {
    return _mm512_fmadd_ps(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m512d fmadd(__m512d a, __m512d b, __m512d c) {
    return _mm512_fmadd_pd(a, b, c);
}
#endif
#endif

// The instruction that returns its second operand if one is NaN or both are zero. Of a comparison and a
// choice, GCC 12 makes up to four.
#if defined(__SSE2__)
[[nodiscard]] [[gnu::always_inline]] inline __m128 larger(__m128 a, __m128 b) {
    return _mm_max_ps(a, b);
}
[[nodiscard]] [[gnu::always_inline]] inline __m128 smaller(__m128 a, __m128 b) {
    return _mm_min_ps(a, b);
}
#ifdef __AVX__
[[nodiscard]] [[gnu::always_inline]] inline __m256 larger(__m256 a, __m256 b) {
    return _mm256_max_ps(a, b);
}
[[nodiscard]] [[gnu::always_inline]] inline __m256 smaller(__m256 a, __m256 b) {
    return _mm256_min_ps(a, b);
}
#endif
#ifdef __AVX512F__
[[nodiscard]] [[gnu::always_inline]] inline __m512 larger(__m512 a, __m512 b) {
    return _mm512_max_ps(a, b);
}
[[nodiscard]] [[gnu::always_inline]] inline __m512 smaller(__m512 a, __m512 b) {
    return _mm512_min_ps(a, b);
}
#endif
#elif defined(__wasm_simd128__)
[[nodiscard]] [[gnu::always_inline]] inline v128_t larger(v128_t a, v128_t b) {
    return wasm_f32x4_pmax(b, a);
}
[[nodiscard]] [[gnu::always_inline]] inline v128_t smaller(v128_t a, v128_t b) {
    return wasm_f32x4_pmin(b, a);
}
#elif defined(__aarch64__)
[[nodiscard]] [[gnu::always_inline]] inline float32x4_t divide(float32x4_t a, float32x4_t b) {
    return vdivq_f32(a, b);
}
[[nodiscard]] [[gnu::always_inline]] inline float32x4_t root(float32x4_t a) {
    return vsqrtq_f32(a);
}
#endif
} // namespace detail

/// a · b + c of vectors of any width, rounded once if the instruction set can.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector fused_multiply_add(const Vector& a, const Vector& b,
                                                                      const Vector& c) {
#ifdef __FMA__
    return Vector(detail::fmadd(a.data, b.data, c.data));
#else
    return xsimd::fma(a, b, c);
#endif
}

#endif

/// a / b, rounded once. Inlined as compilers choose: forced, it would grow functions before their turn comes.
template <class Number>
[[nodiscard]] constexpr Number quotient(const Number& a, const Number& b) {
#if !defined(TACTNET_NO_SIMD) && defined(__aarch64__)
    if constexpr (requires { detail::divide(a.data, b.data); })
        return Number(detail::divide(a.data, b.data));
    else
#endif
        return a / b;
}

}}} // namespace tactnet::kernels

#if !defined(TACTNET_NO_SIMD) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
