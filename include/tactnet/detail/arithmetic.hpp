#pragma once

#include <tactnet/detail/config.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Sizes divided into blocks, among threads and into cache lines, and bits read as another type or in the
// other order.

namespace tactnet { inline namespace TACTNET_ARCH {

/// One thread's share of work. Shares are as equal as possible and depend on the counts alone.
struct work_share {
    std::size_t index = 0, threads = 1;

    /// This share of 0 … count − 1.
    [[nodiscard]] constexpr std::size_t begin(std::size_t count) const { return count * index / threads; }
    [[nodiscard]] constexpr std::size_t end(std::size_t count) const { return count * (index + 1) / threads; }
};

namespace detail {

/// The quotient rounded up: how many blocks of `size` hold `count` elements.
[[nodiscard]] constexpr std::size_t ceil_div(std::size_t count, std::size_t size) {
    return (count + size - 1) / size;
}
/// The smallest multiple of `size` that is not below `count`.
[[nodiscard]] constexpr std::size_t round_up(std::size_t count, std::size_t size) {
    return ceil_div(count, size) * size;
}

/// std::bit_cast, which standard libraries for WebAssembly lack: the same built-in function.
template <class To, class From>
    requires(sizeof(To) == sizeof(From) && std::is_trivially_copyable_v<To> &&
             std::is_trivially_copyable_v<From>)
[[nodiscard]] constexpr To bits_as(const From& value) noexcept {
    return __builtin_bit_cast(To, value);
}

/// std::byteswap, which is newer than this library's C++: the bytes in the other order. Compilers make one
/// instruction of it.
template <std::unsigned_integral T>
    requires(sizeof(T) <= 8)
[[nodiscard]] constexpr T byte_swapped(T value) noexcept {
    if constexpr (sizeof(T) == 8)
        return T{byte_swapped(static_cast<std::uint32_t>(value))} << 32U |
               byte_swapped(static_cast<std::uint32_t>(value >> 32U));
    else if constexpr (sizeof(T) == 4)
        return value >> 24U | (value >> 8U & 0xff00U) | (value << 8U & 0xff0000U) | value << 24U;
    else if constexpr (sizeof(T) == 2)
        return static_cast<T>(value << 8U | value >> 8U);
    else
        return value;
}

} // namespace detail

/// The bytes of a cache line. The arrays of a deployed network begin at cache lines on all targets, so that
/// an exported network is the same for each.
inline constexpr std::size_t cache_line = 64;
/// The alignment in bytes of memory for vectors: no register is wider than a cache line.
inline constexpr std::size_t vector_alignment = cache_line;

/// `count` elements rounded up to whole cache lines, so that what follows them is aligned.
template <class Element = float>
[[nodiscard]] constexpr std::size_t pad_to_cache_line(std::size_t count) {
    return detail::round_up(count, cache_line / sizeof(Element));
}
/// `count` elements rounded up to an odd number of cache lines: as distance between the elements of a tile,
/// it spreads them over the sets of the cache.
template <class Element>
[[nodiscard]] constexpr std::size_t odd_lines(std::size_t count) {
    constexpr std::size_t line = cache_line / sizeof(Element);
    return (detail::ceil_div(count, line) / 2 * 2 + 1) * line;
}

namespace kernels {

using tactnet::detail::ceil_div;
using tactnet::detail::round_up;

} // namespace kernels
}} // namespace tactnet
