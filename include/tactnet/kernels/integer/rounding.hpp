#pragma once

#include <tactnet/kernels/integer/vector.hpp>

#include <cstddef>
#include <cstdint>

// From sums of 32 bits back to bytes: sum × factor, to the nearest whole number, ties to the even one, then
// into a range. One product in single precision, rounded as IEEE 754 says, and whole numbers from there on:
// the same bytes with every instruction set.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// The bytes that a map may hold, and the one that stands for zero.
class byte_range {
public:
    constexpr byte_range(std::int32_t lowest = 0, std::int32_t highest = 255, std::int32_t zero = 0)
        : least_(static_cast<float>(lowest - zero)), most_(static_cast<float>(highest - zero)), zero_(zero) {}
    /// Limits of a number beside the zero, before it is rounded: that leaves whole numbers where they are.
    [[nodiscard]] constexpr float least() const { return least_; }
    [[nodiscard]] constexpr float most() const { return most_; }
    [[nodiscard]] constexpr std::int32_t zero() const { return zero_; }

private:
    float least_, most_;
    std::int32_t zero_;
};

namespace detail {

/// The nearest whole number, ties to the even one, for magnitudes up to 2²²: adding 3 · 2²² leaves it in the
/// last 23 bits. Above them, these.
inline constexpr std::int32_t above_nearest = 0x4B400000;
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> with_nearest(const float_vec<Lanes>& values) {
    const float_vec<Lanes> shifted = values + 0x1.8p23f;
    return load_any<int32_vec<Lanes>>(&shifted);
}

} // namespace detail

/// The nearest whole number, ties to the even one, for magnitudes up to 2²².
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> nearest(const float_vec<Lanes>& values) {
    return detail::with_nearest<Lanes>(values) - detail::above_nearest;
}

namespace detail {

/// The last 8 bits of each.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline uint8_vec<Lanes> last_bytes(const int32_vec<Lanes>& whole) {
    using bytes = uint8_vec<Lanes>;
#if !defined(TACTNET_NO_SIMD) && ((defined(__SSSE3__) && !defined(__AVX512VL__)) || defined(__aarch64__))
    // By a table: GCC 12 would convert them one by one.
    const auto all = load_any<uint8_vec<4 * Lanes>>(&whole);
    if constexpr (Lanes == 4)
        return __builtin_shufflevector(all, all, 0, 4, 8, 12);
    else if constexpr (Lanes == 8)
        return __builtin_shufflevector(all, all, 0, 4, 8, 12, 16, 20, 24, 28);
    else
#endif
        return __builtin_convertvector(whole, bytes);
}

} // namespace detail

/// One byte for each sum: sum × factor + zero, rounded, within the range.
template <std::size_t Lanes>
[[gnu::always_inline]] inline void store_rounded(std::uint8_t* to, const int32_vec<Lanes>& sums,
                                                 const float_vec<Lanes>& factors, const byte_range& range) {
    const float_vec<Lanes> least = range.least() - float_vec<Lanes>{},
                           most = range.most() - float_vec<Lanes>{};
    float_vec<Lanes> values = __builtin_convertvector(sums, float_vec<Lanes>) * factors;
    values = values > least ? values : least;
    values = values < most ? values : most;
    store_any(to, detail::last_bytes<Lanes>(detail::with_nearest<Lanes>(values) + range.zero()));
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
