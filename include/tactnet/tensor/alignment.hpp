#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/detail/round_up.hpp>

#include <cstddef>

// Apart from aligned.hpp, whose allocator throws: deployed networks do without exceptions and heap.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// One cache line, and the widest vector register there is.
inline constexpr std::size_t alignment = 64;

/// Elements in whole cache lines that hold `count`: what lies behind them is aligned.
template <class Element = float>
[[nodiscard]] constexpr std::size_t whole_lines(std::size_t count) {
    constexpr std::size_t line = alignment / sizeof(Element);
    return detail::round_up(count, line);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
