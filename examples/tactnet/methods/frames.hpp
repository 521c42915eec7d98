#pragma once

#include <algorithm>
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

/// body(first, how many) for some images at a time, each of which takes `bytes`: what is found of all of them
/// can exceed the memory.
template <class Body>
void in_parts(std::size_t images, std::size_t bytes, const Body& body) {
    constexpr std::size_t max_bytes = std::size_t{1} << 26U;
    const std::size_t most = std::max<std::size_t>(1, max_bytes / bytes);
    for (std::size_t first = 0; first < images; first += most)
        body(first, std::min(most, images - first));
}
