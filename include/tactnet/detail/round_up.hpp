#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// The quotient rounded up: how many blocks of `size` hold `count` elements.
[[nodiscard]] constexpr std::size_t ceil_div(std::size_t count, std::size_t size) {
    return (count + size - 1) / size;
}
/// The smallest multiple of `size` that is not below `count`.
[[nodiscard]] constexpr std::size_t round_up(std::size_t count, std::size_t size) {
    return ceil_div(count, size) * size;
}

} // namespace detail
namespace kernels {

using tactnet::detail::ceil_div;
using tactnet::detail::round_up;

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
