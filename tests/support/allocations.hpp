#pragma once

#include <cstddef>

namespace support {

/// Calls of operator new so far, by any thread. Programs that link allocations.cpp only.
[[nodiscard]] std::size_t allocations() noexcept;
/// Bytes that they asked for so far, whether given back or not.
[[nodiscard]] std::size_t bytes_allocated() noexcept;

} // namespace support
