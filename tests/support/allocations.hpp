#pragma once

#include <cstddef>

namespace support {

/// Calls of operator new so far, by any thread. A program that calls it has these operators replaced.
[[nodiscard]] std::size_t allocations() noexcept;
/// Bytes that they asked for so far, whether given back or not.
[[nodiscard]] std::size_t bytes_allocated() noexcept;

} // namespace support
