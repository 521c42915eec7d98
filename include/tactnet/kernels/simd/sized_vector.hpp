#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/compiler_vector.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>
#include <type_traits>

// Vectors with a chosen number of lanes. The widest register is best only if there are enough elements to
// fill it: eight filters fill a register of eight lanes and half of one of sixteen.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

#ifndef TACTNET_NO_SIMD

template <class T, std::size_t Lanes>
using sized_vector = xsimd::make_sized_batch_t<T, Lanes>;
/// A number that multiplies all lanes of a vector.
template <class Vector>
using broadcast = Vector;

/// The narrowest vector of this instruction set: 16 bytes.
template <class T>
inline constexpr std::size_t min_lanes = 16 / sizeof(T);

/// The larger of both; `b` if one is NaN. In compiler vectors: of xsimd's mask and choice, GCC makes two
/// instructions, not one, and it warns about xsimd::max in its own header.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector maximum_or_second(const Vector& a, const Vector& b) {
    using values = typename detail::compiler_vector<typename Vector::value_type, Vector::size>::type;
    const values x = load_bytes_as<values>(&a), y = load_bytes_as<values>(&b), larger = x > y ? x : y;
    return load_bytes_as<Vector>(&larger);
}

#else

template <class T, std::size_t>
using sized_vector = vector<T>;
template <class Vector>
using broadcast =
    std::conditional_t<Vector::size == 1, Vector, typename Vector::value_type>; // from a general register
template <class T>
inline constexpr std::size_t min_lanes = lanes<T>;

template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector maximum_or_second(const Vector& a, const Vector& b) {
    return Vector(instructions::larger(a.data, b.data));
}

#endif

template <class Vector, class T>
[[nodiscard]] [[gnu::always_inline]] inline Vector load_as(const T* from) {
    return Vector::load_aligned(from);
}
template <class Vector, class T>
[[gnu::always_inline]] inline void store_as(T* to, const Vector& values) {
    values.store_aligned(to);
}

/// The lanes of the widest vector that `count` values fill, or of the narrowest vector.
template <class T>
[[nodiscard]] constexpr std::size_t lanes_for(std::size_t count) {
    std::size_t width = lanes<T>;
    while (width > count && width > min_lanes<T>)
        width /= 2;
    return width;
}

/// start + the lanes of a vector, added from the first to the last.
template <class T, std::size_t Lanes, class Sum = T, class Vector>
[[nodiscard]] inline Sum add_lanes(const Vector& values, Sum start = Sum{}) {
    alignas(vector_alignment) std::array<T, Lanes> flat;
    store_as(flat.data(), values);
    for (const T lane : flat)
        start += static_cast<Sum>(lane);
    return start;
}
/// totals[i] += lane i.
template <class T>
inline void add_each_lane(double* totals, const vector<T>& values) {
    alignas(vector_alignment) std::array<T, lanes<T>> flat;
    store(flat.data(), values);
    for (std::size_t lane = 0; lane < lanes<T>; ++lane)
        totals[lane] += static_cast<double>(flat[lane]);
}

/// Accumulators that stay in registers.
template <class Vector, std::size_t Pixels, std::size_t Vectors>
using register_block = std::array<std::array<Vector, Vectors>, Pixels>;

}}} // namespace tactnet::kernels
