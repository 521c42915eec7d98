#pragma once

#include <cstddef>
#include <vector>

// For comparisons with what other libraries answer.

namespace support {

/// The share of samples on which both agree.
inline double agreement(const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
    std::size_t same = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        same += a[i] == b[i] ? 1 : 0;
    return static_cast<double>(same) / static_cast<double>(a.size());
}

} // namespace support
