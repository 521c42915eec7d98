#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// One thread's share of work. Shares are as equal as possible and depend on the counts alone.
struct work_share {
    std::size_t index = 0, threads = 1;

    /// This share of 0 … count − 1.
    [[nodiscard]] constexpr std::size_t begin(std::size_t count) const { return count * index / threads; }
    [[nodiscard]] constexpr std::size_t end(std::size_t count) const { return count * (index + 1) / threads; }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
