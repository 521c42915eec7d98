#pragma once

#include <tactnet/kernels/arch/selected.hpp>

#include <cstddef>
#include <cstdint>
#include <type_traits>

// Requantisation: from sums of 32 bits to bytes. A sum is multiplied by a factor, clamped to a range, rounded
// to the nearest integer (ties to even) and moved by the zero point. There is one product in single
// precision, rounded as IEEE 754 requires, and the rest is exact: all instruction sets give the same bytes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The bytes that a map may hold, and the byte that stands for zero.
class byte_range {
public:
    constexpr byte_range(std::int32_t lowest = 0, std::int32_t highest = 255, std::int32_t zero = 0)
        : least_(static_cast<float>(lowest - zero)), most_(static_cast<float>(highest - zero)), zero_(zero) {}
    /// The limits of a number relative to the zero, before rounding, which does not change integers.
    [[nodiscard]] constexpr float least() const { return least_; }
    [[nodiscard]] constexpr float most() const { return most_; }
    [[nodiscard]] constexpr std::int32_t zero() const { return zero_; }

private:
    float least_, most_;
    std::int32_t zero_;
};

namespace detail {

/// Bits of 3 · 2²², which leaves the nearest integer in the last bits of a sum with it.
inline constexpr std::int32_t above_nearest = 0x4B400000;
/// The nearest integer + `above_nearest`; ties to even, for magnitudes up to 2²².
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> with_nearest(const float_vec<Lanes>& values) {
    const float_vec<Lanes> shifted = values + 0x1.8p23f;
    return load_bytes_as<int32_vec<Lanes>>(&shifted);
}

} // namespace detail

/// The nearest integer, ties to even, for magnitudes up to 2²².
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> nearest(const float_vec<Lanes>& values) {
    return detail::with_nearest<Lanes>(values) - detail::above_nearest;
}

namespace detail {

/// The last 8 bits of each integer.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline uint8_vec<Lanes> last_bytes(const int32_vec<Lanes>& whole) {
    // A shuffle, since GCC 12 converts lane by lane.
    const auto all = load_bytes_as<uint8_vec<4 * Lanes>>(&whole);
    if constexpr (instructions::shuffles_bytes && Lanes == 4)
        return __builtin_shufflevector(all, all, 0, 4, 8, 12);
    else if constexpr (instructions::shuffles_bytes && Lanes == 8)
        return __builtin_shufflevector(all, all, 0, 4, 8, 12, 16, 20, 24, 28);
    else
        return instructions::last_bytes<Lanes>(whole);
}

/// `with_nearest` of values clamped to the range relative to its zero; NaN becomes the lowest.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes>
clamped_with_nearest(const float_vec<Lanes>& values, const byte_range& range) {
    return with_nearest<Lanes>(instructions::clamp<Lanes>(values, range.least(), range.most()));
}
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes>
clamped_with_nearest(const int32_vec<Lanes>& sums, const float_vec<Lanes>& factors, const byte_range& range) {
    return clamped_with_nearest<Lanes>(instructions::to_float<Lanes>(sums) * factors, range);
}

} // namespace detail

/// Requantises sums: sum × factor + zero, rounded and clamped to the range, as integers from 0 to 255.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes>
rounded(const int32_vec<Lanes>& sums, const float_vec<Lanes>& factors, const byte_range& range) {
    return detail::clamped_with_nearest<Lanes>(sums, factors, range) + (range.zero() - detail::above_nearest);
}
/// Stores requantised sums as bytes.
template <std::size_t Lanes>
[[gnu::always_inline]] inline void store_rounded(std::uint8_t* to, const int32_vec<Lanes>& sums,
                                                 const float_vec<Lanes>& factors, const byte_range& range) {
    store_any(to, detail::last_bytes<Lanes>(detail::clamped_with_nearest<Lanes>(sums, factors, range) +
                                            range.zero()));
}
/// Stores values, each the result of one rounded product, as bytes: value + zero, rounded and clamped.
template <std::size_t Lanes>
[[gnu::always_inline]] inline void store_rounded(std::uint8_t* to, const float_vec<Lanes>& values,
                                                 const byte_range& range) {
    store_any(to,
              detail::last_bytes<Lanes>(detail::clamped_with_nearest<Lanes>(values, range) + range.zero()));
}

/// How the sums of a convolution begin and what is applied to them, for vectors of `Lanes` filters.
struct integer_epilogue {
    const std::int8_t* starts;  ///< the first terms of the sums, integers of 32 bits
    const std::int8_t* factors; ///< the factors before rounding, in single precision
    const std::int8_t* added; ///< the weights of the other map's bytes, integers of 32 bits, if the step adds
    byte_range range;
    std::uint8_t padding = 0; ///< the byte that stands for zero in the input

    /// The epilogue of the filters from `first` on.
    [[nodiscard]] integer_epilogue from(std::size_t first) const {
        const std::size_t bytes = first * sizeof(std::int32_t);
        return {starts + bytes, factors + bytes, added + bytes, range, padding};
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] int32_vec<Lanes> start(std::size_t vector) const {
        return load_bytes_as<int32_vec<Lanes>>(aligned<4>(starts) + vector * Lanes * sizeof(std::int32_t));
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] float_vec<Lanes> factor(std::size_t vector) const {
        return load_bytes_as<float_vec<Lanes>>(aligned<4>(factors) + vector * Lanes * sizeof(float));
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] int32_vec<Lanes> added_weight(std::size_t vector) const {
        return load_bytes_as<int32_vec<Lanes>>(aligned<4>(added) + vector * Lanes * sizeof(std::int32_t));
    }
    /// The term of the other map, from its bytes.
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] int32_vec<Lanes> added_term(const std::uint8_t* other,
                                                                     std::size_t vector) const {
        return instructions::to_int32<Lanes>(load_bytes_as<uint8_vec<Lanes>>(other)) *
               added_weight<Lanes>(vector);
    }
    /// sum × factor without rounding, after ReLU if `Rectified`.
    template <std::size_t Lanes, bool Rectified>
    [[nodiscard]] [[gnu::always_inline]] static float_vec<Lanes>
    unrounded(int32_vec<Lanes> sums, const float_vec<Lanes>& factors_of_sums) {
        if constexpr (Rectified)
            sums = sums > 0 ? sums : int32_vec<Lanes>{};
        return instructions::to_float<Lanes>(sums) * factors_of_sums;
    }
    /// Stores bytes, or sums without rounding as floats. The range of bytes includes the ReLU.
    template <std::size_t Lanes, bool Rectified, class Output>
    [[gnu::always_inline]] void store(Output* to, const int32_vec<Lanes>& sums,
                                      const float_vec<Lanes>& factors_of_sums) const {
        if constexpr (std::is_same_v<Output, std::uint8_t>)
            store_rounded<Lanes>(to, sums, factors_of_sums, range);
        else
            store_any(to, unrounded<Lanes, Rectified>(sums, factors_of_sums));
    }
};

}}} // namespace tactnet::kernels
