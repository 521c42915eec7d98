#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

// Apart from aligned.hpp, whose allocator throws: deployed networks do without exceptions and heap.

namespace tactnet::inline TACTNET_ARCH {

/// One cache line, and the widest vector register there is.
inline constexpr std::size_t alignment = 64;

} // namespace tactnet
