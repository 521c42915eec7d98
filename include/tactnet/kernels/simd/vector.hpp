#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/detail/round_up.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <type_traits>

#ifndef TACTNET_NO_SIMD
// GCC 12 warns of its own AVX-512 intrinsics, which start from an undefined register on purpose (its bug
// 105593), also where these headers are a system's: it looks at where they are inlined. One place on the way
// that says so is enough.
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

// The few vector operations that the kernels use, on xsimd's widest batch for the instruction set compiled
// for, or on plain numbers when there is none. Kernels name no instruction set.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// a · b + c, rounded once where the instruction set can, at any level of optimisation.
template <std::floating_point T>
[[nodiscard]] inline T fused_multiply_add(const T& a, const T& b, const T& c) {
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
    return std::fma(a, b, c);
#else
    return a * b + c;
#endif
}

#ifndef TACTNET_NO_SIMD

template <class T>
using vector = xsimd::batch<T>;
template <class T>
using mask = typename xsimd::batch<T>::batch_bool_type;
/// Elements in one vector register: also the samples in one group of a batch.
template <class T>
inline constexpr std::size_t lanes = xsimd::batch<T>::size;

template <class T>
[[nodiscard]] inline vector<T> load(const T* from) {
    return vector<T>::load_aligned(from);
}
template <class T>
inline void store(T* to, const vector<T>& values) {
    values.store_aligned(to);
}
namespace detail {
#ifdef __FMA__
// The processor's own instruction for each register. xsimd 8 does not have it behind fma for all of them:
// whether a product is rounded would then depend on compiler and optimisation.
[[nodiscard]] [[gnu::always_inline]] inline __m128 fused(__m128 a, __m128 b, __m128 c) {
    return _mm_fmadd_ps(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m128d fused(__m128d a, __m128d b, __m128d c) {
    return _mm_fmadd_pd(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m256 fused(__m256 a, __m256 b, __m256 c) {
    return _mm256_fmadd_ps(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m256d fused(__m256d a, __m256d b, __m256d c) {
    return _mm256_fmadd_pd(a, b, c);
}
#ifdef __AVX512F__
[[nodiscard]] [[gnu::always_inline]] inline __m512 fused(__m512 a, __m512 b, __m512 c) {
    return _mm512_fmadd_ps(a, b, c);
}
[[nodiscard]] [[gnu::always_inline]] inline __m512d fused(__m512d a, __m512d b, __m512d c) {
    return _mm512_fmadd_pd(a, b, c);
}
#endif
#endif
} // namespace detail

/// a · b + c, of vectors of any width, rounded once where the instruction set can.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector fused_multiply_add(const Vector& a, const Vector& b,
                                                                      const Vector& c) {
#ifdef __FMA__
    return Vector(detail::fused(a.data, b.data, c.data));
#else
    return xsimd::fma(a, b, c);
#endif
}
template <class T>
[[nodiscard]] inline vector<T> multiply_add(const vector<T>& a, const vector<T>& b, const vector<T>& c) {
    return fused_multiply_add(a, b, c);
}
template <class T>
[[nodiscard]] inline vector<T> square_root(const vector<T>& a) {
    return xsimd::sqrt(a);
}
template <class T>
[[nodiscard]] inline vector<T> choose(const mask<T>& condition, const vector<T>& yes, const vector<T>& no) {
    return xsimd::select(condition, yes, no);
}
/// Whether the condition holds in one lane at least.
template <class T>
[[nodiscard]] inline bool any_of(const mask<T>& condition) {
    return xsimd::any(condition);
}
/// As many floats as a vector of doubles has lanes, exactly. Of any alignment.
[[nodiscard]] inline vector<double> widen(const float* from) {
    // By the compiler's own vectors: xsimd 8 converts through memory.
    using floats [[gnu::vector_size(sizeof(float) * lanes<double>)]] = float;
    using doubles [[gnu::vector_size(sizeof(double) * lanes<double>)]] = double;
    floats narrow;
    std::memcpy(&narrow, from, sizeof(narrow));
    return vector<double>(__builtin_convertvector(narrow, doubles));
}
/// The same the other way, rounded. Of any alignment.
inline void narrow(float* to, const vector<double>& values) {
    using floats [[gnu::vector_size(sizeof(float) * lanes<double>)]] = float;
    using doubles [[gnu::vector_size(sizeof(double) * lanes<double>)]] = double;
    doubles wide;
    std::memcpy(&wide, &values.data, sizeof(wide));
    const floats rounded = __builtin_convertvector(wide, floats);
    std::memcpy(to, &rounded, sizeof(rounded));
}
/// Element i of the result is the sum over the lanes of rows[i]. Registers of 64 bytes are folded to halves
/// first: xsimd 8's own sums of those come out in another order in single precision.
template <class T>
[[nodiscard]] inline vector<T> sums_across_lanes(const std::array<vector<T>, lanes<T>>& rows) {
    if constexpr (sizeof(vector<T>) <= 32) {
        return xsimd::haddp(rows.data());
    } else {
        constexpr std::size_t narrow = lanes<T> / 2;
        using half = xsimd::make_sized_batch_t<T, narrow>;
        alignas(64) std::array<T, lanes<T>> flat;
        alignas(64) std::array<T, lanes<T>> sums;
        for (std::size_t first = 0; first < lanes<T>; first += narrow) {
            std::array<half, narrow> folded;
            for (std::size_t i = 0; i < narrow; ++i) {
                store(flat.data(), rows[first + i]);
                folded[i] = half::load_aligned(flat.data()) + half::load_aligned(flat.data() + narrow);
            }
            xsimd::haddp(folded.data()).store_aligned(sums.data() + first);
        }
        return load(sums.data());
    }
}

#else

/// A register of one lane, so that kernels read the same with and without SIMD.
template <class T>
struct vector {
    using value_type = T;
    T value;

    vector() = default;
    vector(T v) : value(v) {}
    friend vector operator+(vector a, vector b) { return a.value + b.value; }
    friend vector operator-(vector a, vector b) { return a.value - b.value; }
    friend vector operator*(vector a, vector b) { return a.value * b.value; }
    friend vector operator/(vector a, vector b) { return a.value / b.value; }
    friend vector& operator+=(vector& a, vector b) { return a = a + b; }
    friend bool operator>(vector a, vector b) { return a.value > b.value; }
    friend bool operator<(vector a, vector b) { return a.value < b.value; }
    friend bool operator==(vector a, vector b) { return a.value == b.value; }
    friend bool operator!=(vector a, vector b) { return a.value != b.value; }
};
template <class T>
using mask = bool;
template <class T>
inline constexpr std::size_t lanes = 1;

template <class T>
[[nodiscard]] inline vector<T> load(const T* from) {
    return *from;
}
template <class T>
inline void store(T* to, const vector<T>& values) {
    *to = values.value;
}
template <class T>
[[nodiscard]] inline vector<T> multiply_add(const vector<T>& a, const vector<T>& b, const vector<T>& c) {
    return fused_multiply_add(a.value, b.value, c.value);
}
template <class T>
[[nodiscard]] inline vector<T> fused_multiply_add(const vector<T>& a, const vector<T>& b,
                                                  const vector<T>& c) {
    return multiply_add(a, b, c);
}
template <class T>
[[nodiscard]] inline vector<T> square_root(const vector<T>& a) {
    return std::sqrt(a.value);
}
template <class T>
[[nodiscard]] inline vector<T> choose(bool condition, const vector<T>& yes, const vector<T>& no) {
    return condition ? yes : no;
}
template <class T>
[[nodiscard]] inline bool any_of(bool condition) {
    return condition;
}
[[nodiscard]] inline vector<double> widen(const float* from) {
    return static_cast<double>(*from);
}
inline void narrow(float* to, const vector<double>& values) {
    *to = static_cast<float>(values.value);
}
template <class T>
[[nodiscard]] inline vector<T> sums_across_lanes(const std::array<vector<T>, 1>& rows) {
    return rows[0];
}

#endif

#if !defined(TACTNET_NO_SIMD) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

/// Leaves what was loaded in its register. GCC would load it again for each product where it is used, though
/// loads over two lines of the cache take twice as long.
template <class Vector>
[[gnu::always_inline]] inline void keep_in_register([[maybe_unused]] Vector& values) {
#if !defined(TACTNET_NO_SIMD) && defined(__AVX512F__) && defined(__GNUC__) && !defined(__clang__)
    asm("" : "+v"(values.data));
#endif
}

/// The larger of both; a NaN in either is kept, so that a broken number is seen and not hidden by a pool.
template <class T>
[[nodiscard]] inline vector<T> maximum_keeping_nan(const vector<T>& a, const vector<T>& b) {
    return choose<T>((a > b) || !(a == a), a, b); // xsimd 8's != takes NaN as equal to itself with AVX-512
}

/// Elements in whole vectors that hold `count`.
template <class T>
[[nodiscard]] constexpr std::size_t padded_size(std::size_t count) {
    return round_up(count, lanes<T>);
}

/// Vector registers that kernels may plan with.
#if defined(__AVX512F__) || defined(__aarch64__)
inline constexpr std::size_t vector_registers = 32;
#else
inline constexpr std::size_t vector_registers = 16;
#endif
/// Of these, sums that a register block may hold: as many as leave room for inputs and weights, since each
/// block also costs what does not depend on its size.
inline constexpr std::size_t max_block_sums = vector_registers == 32 ? 24 : 12;

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
