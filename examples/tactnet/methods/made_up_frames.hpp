#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

/// Frames for timing; their values do not matter.
inline std::vector<std::uint8_t> made_up_frames(std::size_t pixels) {
    std::vector<std::uint8_t> counts(pixels);
    for (std::size_t e = 0; e < pixels; ++e)
        counts[e] = static_cast<std::uint8_t>(e * 37 % 64);
    return counts;
}
