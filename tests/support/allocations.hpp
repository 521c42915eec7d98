#pragma once

#include <cstddef>

namespace support {

/// Calls of operator new so far, by any thread. Programs that link allocations.cpp only.
[[nodiscard]] std::size_t allocations() noexcept;

} // namespace support
