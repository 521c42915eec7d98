#pragma once

#include <tactnet/detail/config.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

// Numbers in binary data, byte by byte, whatever the order of this machine.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The unsigned number at the start of `bytes`, which holds at least one, lowest byte first.
template <std::unsigned_integral T>
[[nodiscard]] constexpr T little_endian(std::span<const std::byte> bytes) noexcept {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[i]) << (8 * i)));
    return value;
}

/// The same, highest byte first.
template <std::unsigned_integral T>
[[nodiscard]] constexpr T big_endian(std::span<const std::byte> bytes) noexcept {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[sizeof(T) - 1 - i]) << (8 * i)));
    return value;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
