#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <cstdint>

// Vectors of whole numbers and of single precision beside them, as the compiler has them: xsimd has neither
// the products of bytes that networks of 8 bits live on nor conversions that are the same in all its
// versions.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

template <std::size_t Lanes>
struct integer_lanes {
    using integers [[gnu::vector_size(4 * Lanes)]] = std::int32_t;
    using numbers [[gnu::vector_size(4 * Lanes)]] = float;
    using words [[gnu::vector_size(2 * Lanes)]] = std::int16_t;
    using bytes [[gnu::vector_size(Lanes)]] = std::uint8_t;
};
template <std::size_t Lanes>
using integers = typename integer_lanes<Lanes>::integers;
template <std::size_t Lanes>
using numbers = typename integer_lanes<Lanes>::numbers;

/// Bytes as whole numbers. Step by step: GCC 12 takes them one by one where their size more than doubles.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline integers<Lanes>
whole_of_bytes(const typename integer_lanes<Lanes>::bytes& values) {
    const auto words = __builtin_convertvector(values, typename integer_lanes<Lanes>::words);
    return __builtin_convertvector(words, integers<Lanes>);
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
