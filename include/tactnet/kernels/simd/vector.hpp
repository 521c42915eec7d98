#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/simd/xsimd.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

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

namespace detail {

/// A condition in each lane. Not a vector of the compiler: of Helium's comparisons, GCC 12 makes wrong code.
template <std::size_t Lanes>
struct mask_of_lanes {
    std::array<bool, Lanes> holds;

    friend mask_of_lanes operator!(mask_of_lanes a) {
        for (bool& lane : a.holds)
            lane = !lane;
        return a;
    }
    friend mask_of_lanes operator||(mask_of_lanes a, const mask_of_lanes& b) {
        for (std::size_t lane = 0; lane < Lanes; ++lane)
            a.holds[lane] = a.holds[lane] || b.holds[lane];
        return a;
    }
    friend mask_of_lanes operator&&(const mask_of_lanes& a, const mask_of_lanes& b) { return !(!a || !b); }
};

} // namespace detail

/// The elements of a register: one, or those of a vector that the instruction set has without xsimd.
template <class T>
inline constexpr std::size_t lanes = std::is_same_v<T, float> ? instructions::float_lanes : 1;

/// Such a register, so that kernels are the same with and without SIMD.
template <class T>
struct vector {
    using value_type = T;
    static constexpr std::size_t size = lanes<T>;
    using register_type =
        typename std::conditional_t<size == 1, std::type_identity<T>, detail::compiler_vector<T, size>>::type;
    register_type data;

    vector() = default;
    vector(T v) : data(v - register_type{}) {}
    explicit vector(const register_type& v)
        requires(size > 1)
        : data(v) {}
    [[nodiscard]] static vector load_aligned(const T* from) {
        if constexpr (size == 1)
            return *from;
        else
            return vector(*reinterpret_cast<const register_type*>(from));
    }
    [[nodiscard]] static vector load_unaligned(const T* from) {
        return vector(load_bytes_as<register_type>(from));
    }
    void store_aligned(T* to) const {
        if constexpr (size == 1)
            *to = data;
        else
            *reinterpret_cast<register_type*>(to) = data;
    }
    void store_unaligned(T* to) const { store_any(to, data); }
    friend vector operator+(const vector& a, const vector& b) { return vector(a.data + b.data); }
    friend vector operator-(const vector& a, const vector& b) { return vector(a.data - b.data); }
    friend vector operator*(const vector& a, const vector& b) { return vector(a.data * b.data); }
    friend vector operator/(const vector& a, const vector& b) { return vector(a.data / b.data); }
    friend vector& operator+=(vector& a, const vector& b) { return a = a + b; }
    friend auto operator>(const vector& a, const vector& b) {
        return compared(a, b, [](T x, T y) { return x > y; });
    }
    friend auto operator<(const vector& a, const vector& b) {
        return compared(a, b, [](T x, T y) { return x < y; });
    }
    friend auto operator==(const vector& a, const vector& b) {
        return compared(a, b, [](T x, T y) { return x == y; });
    }
    friend auto operator!=(const vector& a, const vector& b) {
        return compared(a, b, [](T x, T y) { return x != y; });
    }

private:
    template <class Holds>
    [[nodiscard]] static auto compared(const vector& a, const vector& b, const Holds& holds) {
        if constexpr (size == 1) {
            return holds(a.data, b.data);
        } else {
            detail::mask_of_lanes<size> result;
            for (std::size_t lane = 0; lane < size; ++lane)
                result.holds[lane] = holds(a.data[lane], b.data[lane]);
            return result;
        }
    }
};
template <class T>
using mask = decltype(vector<T>{} > vector<T>{});

template <class T>
[[nodiscard]] [[gnu::always_inline]] inline vector<T>
fused_multiply_add(const vector<T>& a, const vector<T>& b, const vector<T>& c) {
    if constexpr (lanes<T> == 1)
        return fused_multiply_add(a.data, b.data, c.data);
    else
        return vector<T>(instructions::multiply_add(a.data, b.data, c.data));
}
/// b is the same for all lanes.
template <class T>
    requires(lanes<T> > 1)
[[nodiscard]] [[gnu::always_inline]] inline vector<T> fused_multiply_add(const vector<T>& a, T b,
                                                                         const vector<T>& c) {
    return vector<T>(instructions::multiply_add(a.data, b, c.data));
}
/// One lane of a vector, and a vector of element(lane) in each: for what is rarely computed.
template <class Vector>
[[nodiscard]] inline auto lane_of(const Vector& values, std::size_t lane) {
    if constexpr (Vector::size == 1)
        return values.data;
    else
        return values.data[lane];
}
template <class Vector, class Element>
[[nodiscard]] inline Vector each_lane(const Element& element) {
    if constexpr (Vector::size == 1) {
        return element(0);
    } else {
        Vector values;
        for (std::size_t lane = 0; lane < Vector::size; ++lane)
            values.data[lane] = element(lane);
        return values;
    }
}
template <class T>
[[nodiscard]] inline vector<T> square_root(const vector<T>& a) {
    return each_lane<vector<T>>([&](std::size_t lane) { return std::sqrt(lane_of(a, lane)); });
}
template <class T>
[[nodiscard]] inline vector<T> choose(const mask<T>& condition, const vector<T>& yes, const vector<T>& no) {
    if constexpr (lanes<T> == 1)
        return condition ? yes : no;
    else
        return each_lane<vector<T>>(
            [&](std::size_t lane) { return condition.holds[lane] ? lane_of(yes, lane) : lane_of(no, lane); });
}
template <class T>
[[nodiscard]] inline bool any_of(const mask<T>& condition) {
    if constexpr (lanes<T> == 1) {
        return condition;
    } else {
        bool any = false;
        for (const bool lane : condition.holds)
            any = any || lane;
        return any;
    }
}
[[nodiscard]] inline vector<double> widen(const float* from) {
    return static_cast<double>(*from);
}
inline void narrow(float* to, const vector<double>& values) {
    *to = static_cast<float>(values.data);
}
template <class T>
[[nodiscard]] inline vector<T> sums_across_lanes(const std::array<vector<T>, lanes<T>>& rows) {
    return each_lane<vector<T>>([&](std::size_t row) {
        T sum = lane_of(rows[row], 0);
        for (std::size_t lane = 1; lane < lanes<T>; ++lane)
            sum += lane_of(rows[row], lane);
        return sum;
    });
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
inline constexpr std::size_t vector_registers = instructions::vector_registers;
#endif
/// The accumulators of a register block: as many as leave room for inputs and weights, since a block also has
/// a fixed cost.
inline constexpr std::size_t max_block_sums = vector_registers * 3 / 4;

}}} // namespace tactnet::kernels
