#pragma once

#include <tactnet/kernels/arch/compiler_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

// Four vectors of bytes interleaved to lanes of 32 bits, with one byte of each vector per lane, and the
// inverse. Instructions interleave within 16 bytes, hence the order: lane j of result v holds the bytes at 16
// (j / 4) + 4 v + j % 4.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The lane of a byte's place, counted over the four results: v × Lanes + j.
template <std::size_t Lanes>
[[nodiscard]] constexpr std::size_t interleaved_place(std::size_t byte) {
    return byte % 16 / 4 * Lanes + byte / 16 * 4 + byte % 4;
}

namespace detail {

/// Alternates elements of a and b, from the lower or the upper half of each 16 bytes.
template <bool Upper, class Vector, std::size_t... I>
[[gnu::always_inline]] inline Vector in_turns(const Vector& a, const Vector& b, std::index_sequence<I...>) {
    constexpr std::size_t n = sizeof...(I), row = 16 * n / sizeof(Vector);
    return __builtin_shufflevector(
        a, b, static_cast<int>(I / row * row + (Upper ? row / 2 : 0) + I % row / 2 + I % 2 * n)...);
}
} // namespace detail

/// Interleaves four vectors: a lane holds a byte of a, b, c and d, in this order.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline std::array<uint8_vec<4 * Lanes>, 4>
interleave(const uint8_vec<4 * Lanes>& a, const uint8_vec<4 * Lanes>& b, const uint8_vec<4 * Lanes>& c,
           const uint8_vec<4 * Lanes>& d) {
    using bytes = uint8_vec<4 * Lanes>;
    using words = int16_vec<2 * Lanes>;
    constexpr std::make_index_sequence<4 * Lanes> all;
    constexpr std::make_index_sequence<2 * Lanes> half;
    const auto lower_ab = reinterpret_cast<words>(detail::in_turns<false>(a, b, all)),
               lower_cd = reinterpret_cast<words>(detail::in_turns<false>(c, d, all)),
               upper_ab = reinterpret_cast<words>(detail::in_turns<true>(a, b, all)),
               upper_cd = reinterpret_cast<words>(detail::in_turns<true>(c, d, all));
    return {reinterpret_cast<bytes>(detail::in_turns<false>(lower_ab, lower_cd, half)),
            reinterpret_cast<bytes>(detail::in_turns<true>(lower_ab, lower_cd, half)),
            reinterpret_cast<bytes>(detail::in_turns<false>(upper_ab, upper_cd, half)),
            reinterpret_cast<bytes>(detail::in_turns<true>(upper_ab, upper_cd, half))};
}

/// Loads the first `Count` bytes of a vector of `Bytes`, and reads no others; the rest is zero.
template <std::size_t Bytes, std::size_t Count>
[[nodiscard]] [[gnu::always_inline]] inline uint8_vec<Bytes> load_first(const std::uint8_t* from) {
    if constexpr (Count >= Bytes) {
        return load_bytes_as<uint8_vec<Bytes>>(from);
    } else if constexpr (Bytes > 16) {
        // By halves, or compilers assemble the vector in memory.
        constexpr std::size_t half = Bytes / 2;
        uint8_vec<half> upper{};
        if constexpr (Count > half)
            upper = load_first<half, Count - half>(from + half);
        return [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
            return __builtin_shufflevector(load_first<half, std::min(Count, half)>(from), upper,
                                           static_cast<int>(I)...);
        }
        (std::make_index_sequence<Bytes>{});
    } else {
        std::uint64_t lower = 0, upper = 0;
        std::memcpy(&lower, from, std::min<std::size_t>(Count, 8));
        if constexpr (Count > 8)
            std::memcpy(&upper, from + 8, Count - 8);
        using pair [[gnu::vector_size(16)]] = std::uint64_t;
        return reinterpret_cast<uint8_vec<16>>(pair{lower, upper});
    }
}

}}} // namespace tactnet::kernels
