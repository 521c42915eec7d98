#pragma once

#include <algorithm>
#include <cstddef>

/// body(first, how many) for some images at a time, where each takes `bytes`: what is found of all of them
/// can be more than there is memory.
template <class Body>
void in_parts(std::size_t images, std::size_t bytes, const Body& body) {
    constexpr std::size_t most_bytes = std::size_t{1} << 26U;
    const std::size_t most = std::max<std::size_t>(1, most_bytes / bytes);
    for (std::size_t first = 0; first < images; first += most)
        body(first, std::min(most, images - first));
}
