#pragma once

#include <tactnet/detail/arithmetic.hpp>

#include <cstddef>

// Not in aligned.hpp, whose allocator throws: deployed networks use neither exceptions nor the heap.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The bytes of a cache line and of the widest vector register.
inline constexpr std::size_t alignment = 64;

/// `count` elements rounded up to whole cache lines, so that what follows them is aligned.
template <class Element = float>
[[nodiscard]] constexpr std::size_t whole_lines(std::size_t count) {
    constexpr std::size_t line = alignment / sizeof(Element);
    return detail::round_up(count, line);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
