#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

// Vectors along the rows of images, which are not aligned and not a multiple of the lanes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

template <class Vector, class T>
[[nodiscard]] [[gnu::always_inline]] inline Vector load_unaligned(const T* from) {
    return Vector::load_unaligned(from);
}
template <class Vector, class T>
[[gnu::always_inline]] inline void store_anywhere(T* to, const Vector& values) {
    values.store_unaligned(to);
}

#ifndef TACTNET_NO_SIMD

/// Loads bytes and converts them to floats.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector load_floats(const std::uint8_t* from) {
    constexpr std::size_t size = Vector::size;
    uint8_vec<size> values;
    std::memcpy(&values, from, sizeof(values));
    return Vector(__builtin_convertvector(instructions::to_int32<size>(values), float_vec<size>));
}
/// Clamps to low … high; NaN becomes `low`. In compiler vectors, which give two instructions; converted to
/// floats, since WebAssembly's register type is one of integers.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector clamp(const Vector& a, const Vector& low,
                                                         const Vector& high) {
    using floats = float_vec<Vector::size>;
    const auto least = (floats)low.data, most = (floats)high.data, value = (floats)a.data;
    const floats above = value > least ? value : least;
    return Vector(above < most ? above : most);
}
/// `yes` where a is zero, else `no`.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector select_if_zero(const Vector& a, const Vector& yes,
                                                                  const Vector& no) {
    return xsimd::select(a == Vector(0), yes, no);
}
/// Whether no lane is NaN or infinite.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline bool all_finite(const Vector& a) {
    return xsimd::all(a - a == Vector(0));
}
/// Rounds towards zero; for magnitudes below 2³¹.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector truncate(const Vector& a) {
    return xsimd::to_float(xsimd::to_int(a));
}
/// Converts to integers, towards zero, and stores them.
template <class Vector>
[[gnu::always_inline]] inline void store_int32(std::int32_t* to, const Vector& a) {
    xsimd::to_int(a).store_unaligned(to);
}
/// The elements with even indices and those with odd indices of a sequence of two vectors.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline std::array<Vector, 2> deinterleave(const Vector& a,
                                                                               const Vector& b) {
    return [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
        return std::array{Vector(__builtin_shufflevector(a.data, b.data, (2 * I)...)),
                          Vector(__builtin_shufflevector(a.data, b.data, (2 * I + 1)...))};
    }
    (std::make_integer_sequence<int, static_cast<int>(Vector::size)>{});
}
/// The elements of `a` and `b` in turns: the inverse of deinterleave.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline std::array<Vector, 2> interleave(const Vector& a,
                                                                             const Vector& b) {
    constexpr int size = static_cast<int>(Vector::size);
    return [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
        return std::array{
            Vector(__builtin_shufflevector(a.data, b.data, (I / 2 + I % 2 * size)...)),
            Vector(__builtin_shufflevector(a.data, b.data, (size / 2 + I / 2 + I % 2 * size)...))};
    }
    (std::make_integer_sequence<int, size>{});
}
/// Repeats each element three times, in three vectors.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline std::array<Vector, 3> repeat_three(const Vector& a) {
    constexpr int size = static_cast<int>(Vector::size);
    return [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
        return std::array{Vector(__builtin_shufflevector(a.data, a.data, (I / 3)...)),
                          Vector(__builtin_shufflevector(a.data, a.data, ((size + I) / 3)...)),
                          Vector(__builtin_shufflevector(a.data, a.data, ((2 * size + I) / 3)...))};
    }
    (std::make_integer_sequence<int, size>{});
}

#else

template <class Vector>
[[nodiscard]] inline Vector load_floats(const std::uint8_t* from) {
    return each_lane<Vector>([&](std::size_t lane) { return static_cast<float>(from[lane]); });
}
template <class Vector>
[[nodiscard]] inline Vector clamp(const Vector& a, const Vector& low, const Vector& high) {
    const auto above = choose<float>(a > low, a, low);
    return choose<float>(above < high, above, high);
}
template <class Vector>
[[nodiscard]] inline Vector select_if_zero(const Vector& a, const Vector& yes, const Vector& no) {
    return choose<float>(a == Vector(0), yes, no);
}
template <class Vector>
[[nodiscard]] inline bool all_finite(const Vector& a) {
    return !any_of<float>(a - a != Vector(0));
}
template <class Vector>
[[nodiscard]] inline Vector truncate(const Vector& a) {
    return each_lane<Vector>(
        [&](std::size_t lane) { return static_cast<float>(static_cast<std::int32_t>(lane_of(a, lane))); });
}
template <class Vector>
inline void store_int32(std::int32_t* to, const Vector& a) {
    for (std::size_t lane = 0; lane < Vector::size; ++lane)
        to[lane] = static_cast<std::int32_t>(lane_of(a, lane));
}
template <class Vector>
[[nodiscard]] inline std::array<Vector, 2> deinterleave(const Vector& a, const Vector& b) {
    constexpr std::size_t size = Vector::size;
    const auto of = [&](std::size_t i) { return lane_of(i < size ? a : b, i % size); };
    return {each_lane<Vector>([&](std::size_t lane) { return of(2 * lane); }),
            each_lane<Vector>([&](std::size_t lane) { return of(2 * lane + 1); })};
}
template <class Vector>
[[nodiscard]] inline std::array<Vector, 2> interleave(const Vector& a, const Vector& b) {
    const auto half = [&](std::size_t first) {
        return each_lane<Vector>(
            [&](std::size_t lane) { return lane_of((first + lane) % 2 == 0 ? a : b, (first + lane) / 2); });
    };
    return {half(0), half(Vector::size)};
}
template <class Vector>
[[nodiscard]] inline std::array<Vector, 3> repeat_three(const Vector& a) {
    const auto third = [&](std::size_t first) {
        return each_lane<Vector>([&](std::size_t lane) { return lane_of(a, (first + lane) / 3); });
    };
    return {third(0), third(Vector::size), third(2 * Vector::size)};
}

#endif

/// Vector i of the result holds the elements i, i + Ways, i + 2 · Ways … of a sequence of vectors. `Ways` is
/// a power of two.
template <class Vector, std::size_t Ways>
[[nodiscard]] [[gnu::always_inline]] inline std::array<Vector, Ways>
deinterleave(const std::array<Vector, Ways>& sequence) {
    if constexpr (Ways == 1) {
        return sequence;
    } else {
        std::array<Vector, Ways / 2> even, odd;
        unroll<Ways / 2>([&](auto i) {
            const auto halves = deinterleave(sequence[2 * i], sequence[2 * i + 1]);
            even[i] = halves[0], odd[i] = halves[1];
        });
        even = deinterleave(even), odd = deinterleave(odd);
        std::array<Vector, Ways> result;
        unroll<Ways / 2>([&](auto i) { result[2 * i] = even[i], result[2 * i + 1] = odd[i]; });
        return result;
    }
}

/// Loads floats with any alignment.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector load_floats(const float* from) {
    return load_unaligned<Vector>(from);
}

/// The number of vectors that cover `count` elements, and where each begins. The last one overlaps its
/// neighbour instead of reaching beyond the end, unless there are fewer elements than lanes.
[[nodiscard]] constexpr std::size_t row_vectors(std::size_t count, std::size_t lanes_of_one) {
    return ceil_div(count, lanes_of_one);
}
[[nodiscard]] constexpr std::size_t row_vector_begin(std::size_t index, std::size_t count,
                                                     std::size_t lanes_of_one) {
    const std::size_t begin = index * lanes_of_one;
    return begin + lanes_of_one <= count || count < lanes_of_one ? begin : count - lanes_of_one;
}

/// The lanes for rows of `count` elements. One register of 64 bytes takes at most as long as two of 32; the
/// narrower ones are used if they leave less of the last register unused.
template <class T>
[[nodiscard]] constexpr std::size_t row_lanes(std::size_t count) {
    const std::size_t width = lanes_for<T>(count);
    const bool halves =
        width * sizeof(T) == 64 && row_vectors(count, width / 2) < 2 * row_vectors(count, width);
    return halves ? width / 2 : width;
}

/// Stores a vector in a row of `Count` elements: all lanes, or the first `Count`.
template <std::size_t Count, std::size_t Lanes, class Vector>
[[gnu::always_inline]] inline void store_in_row(float* to, const Vector& values) {
    if constexpr (Count >= Lanes) {
        store_anywhere(to, values);
    } else {
        alignas(vector_alignment) std::array<float, Lanes> all;
        store_as(all.data(), values);
        for (std::size_t i = 0; i < Count; ++i)
            to[i] = all[i];
    }
}

}}} // namespace tactnet::kernels
