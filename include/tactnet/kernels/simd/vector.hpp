#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/xsimd.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

// The vector operations of the kernels: on xsimd's widest batch for the target's instruction set, or on
// scalars without SIMD. Kernels name no instruction set.

#if !defined(TACTNET_NO_SIMD) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push // as in xsimd.hpp
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

#ifndef TACTNET_NO_SIMD

template <class T>
using vector = xsimd::batch<T>;
template <class T>
using mask = typename xsimd::batch<T>::batch_bool_type;
/// The elements of a vector register, and the samples of a lane block.
template <class T>
inline constexpr std::size_t lanes = xsimd::batch<T>::size;
static_assert(sizeof(vector<float>) <= vector_alignment,
              "kernels: vector registers have at most 64 bytes; compile for shorter ones, with "
              "-msve-vector-bits=512 or less");

template <class T>
[[nodiscard]] inline vector<T> square_root(const vector<T>& a) {
#if defined(__aarch64__)
    if constexpr (requires { detail::root(a.data); })
        return vector<T>(detail::root(a.data));
    else
#endif
        return xsimd::sqrt(a);
}
template <class T>
[[nodiscard]] inline vector<T> choose(const mask<T>& condition, const vector<T>& yes, const vector<T>& no) {
    return xsimd::select(condition, yes, no);
}
/// Whether the condition holds in at least one lane.
template <class T>
[[nodiscard]] inline bool any_of(const mask<T>& condition) {
    return xsimd::any(condition);
}
/// Loads floats with any alignment and converts them to doubles.
[[nodiscard]] inline vector<double> widen(const float* from) {
    // In compiler vectors: xsimd 8 converts through memory.
    using floats [[gnu::vector_size(sizeof(float) * lanes<double>)]] = float;
    using doubles [[gnu::vector_size(sizeof(double) * lanes<double>)]] = double;
    floats narrow;
    std::memcpy(&narrow, from, sizeof(narrow));
    return vector<double>(__builtin_convertvector(narrow, doubles));
}
/// Rounds doubles to floats and stores them with any alignment.
inline void narrow(float* to, const vector<double>& values) {
    using floats [[gnu::vector_size(sizeof(float) * lanes<double>)]] = float;
    using doubles [[gnu::vector_size(sizeof(double) * lanes<double>)]] = double;
    doubles wide;
    std::memcpy(&wide, &values.data, sizeof(wide));
    const floats rounded = __builtin_convertvector(wide, floats);
    std::memcpy(to, &rounded, sizeof(rounded));
}
/// Element i of the result is the sum of the lanes of rows[i]. Registers of 64 bytes are first folded to
/// halves: xsimd 8 sums them in another order in single precision.
template <class T>
[[nodiscard]] inline vector<T> sums_across_lanes(const std::array<vector<T>, lanes<T>>& rows) {
    if constexpr (sizeof(vector<T>) <= 32) {
        return xsimd::haddp(rows.data());
    } else {
        constexpr std::size_t narrow = lanes<T> / 2;
        using half = xsimd::make_sized_batch_t<T, narrow>;
        alignas(vector_alignment) std::array<T, lanes<T>> flat;
        alignas(vector_alignment) std::array<T, lanes<T>> sums;
        for (std::size_t first = 0; first < lanes<T>; first += narrow) {
            std::array<half, narrow> folded;
            for (std::size_t i = 0; i < narrow; ++i) {
                rows[first + i].store_aligned(flat.data());
                folded[i] = half::load_aligned(flat.data()) + half::load_aligned(flat.data() + narrow);
            }
            xsimd::haddp(folded.data()).store_aligned(sums.data() + first);
        }
        return vector<T>::load_aligned(sums.data());
    }
}

#else

/// A register of one lane, so that kernels are the same with and without SIMD.
template <class T>
struct vector {
    using value_type = T;
    T value;

    vector() = default;
    vector(T v) : value(v) {}
    [[nodiscard]] static vector load_aligned(const T* from) { return *from; }
    [[nodiscard]] static vector load_unaligned(const T* from) { return *from; }
    void store_aligned(T* to) const { *to = value; }
    void store_unaligned(T* to) const { *to = value; }
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
[[nodiscard]] inline vector<T> fused_multiply_add(const vector<T>& a, const vector<T>& b,
                                                  const vector<T>& c) {
    return fused_multiply_add(a.value, b.value, c.value);
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

template <class T>
[[nodiscard]] inline vector<T> load(const T* from) {
    return vector<T>::load_aligned(from);
}
template <class T>
inline void store(T* to, const vector<T>& values) {
    values.store_aligned(to);
}
template <class T>
[[nodiscard]] inline vector<T> multiply_add(const vector<T>& a, const vector<T>& b, const vector<T>& c) {
    return fused_multiply_add(a, b, c);
}

/// Keeps a loaded value in its register. GCC would load it again for each product, though loads that cross a
/// cache line take twice as long.
template <class Vector>
[[gnu::always_inline]] inline void keep_in_register([[maybe_unused]] Vector& values) {
#if !defined(TACTNET_NO_SIMD) && defined(__AVX512F__) && defined(__GNUC__) && !defined(__clang__)
    asm("" : "+v"(values.data));
#endif
}

/// The larger of both; NaN if either is NaN, so that a pool does not hide it.
template <class T>
[[nodiscard]] inline vector<T> maximum_keeping_nan(const vector<T>& a, const vector<T>& b) {
    return choose<T>((a > b) || !(a == a), a, b); // with AVX-512, xsimd 8's NaN != NaN is false
}

/// `count` elements rounded up to whole vectors.
template <class T>
[[nodiscard]] constexpr std::size_t padded_size(std::size_t count) {
    return round_up(count, lanes<T>);
}

/// The vector registers of the target.
#if defined(__AVX512F__) || defined(__aarch64__)
inline constexpr std::size_t vector_registers = 32;
#else
inline constexpr std::size_t vector_registers = 16;
#endif
/// The accumulators of a register block: as many as leave room for inputs and weights, since a block also has
/// a fixed cost.
inline constexpr std::size_t max_block_sums = vector_registers >= 32 ? 24 : 12;

}}} // namespace tactnet::kernels
