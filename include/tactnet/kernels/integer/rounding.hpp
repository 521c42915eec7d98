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
struct byte_range {
    std::int32_t lowest = 0, highest = 255, zero = 0;
};

/// The nearest whole number, ties to the even one, for magnitudes up to 2²²: adding 3 · 2²² leaves it in the
/// last bits.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline integers<Lanes> nearest(const numbers<Lanes>& values) {
    constexpr std::int32_t bits_of_shift = 0x4B400000;
    const numbers<Lanes> shifted = values + 0x1.8p23f;
    return load_any<integers<Lanes>>(&shifted) - bits_of_shift;
}

/// One byte for each sum: sum × factor + zero, rounded, within the range.
template <std::size_t Lanes>
[[gnu::always_inline]] inline void store_rounded(std::uint8_t* to, const integers<Lanes>& sums,
                                                 const numbers<Lanes>& factors, const byte_range& range) {
    // Limits before rounding, which leaves whole numbers where they are.
    const numbers<Lanes> lowest = numbers<Lanes>{} + static_cast<float>(range.lowest - range.zero),
                         highest = numbers<Lanes>{} + static_cast<float>(range.highest - range.zero);
    numbers<Lanes> values = __builtin_convertvector(sums, numbers<Lanes>) * factors;
    values = values > lowest ? values : lowest;
    values = values < highest ? values : highest;
    store_any(to, __builtin_convertvector(nearest<Lanes>(values) + range.zero,
                                          typename integer_lanes<Lanes>::bytes));
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
