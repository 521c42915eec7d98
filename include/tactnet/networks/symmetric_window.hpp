#pragma once

#include <tactnet/tensor/shape.hpp>

#include <cstddef>

// Windows that lie symmetrically on a map, so that a network samples an image and its reflections at the same
// places. With stride 2, a window of 2 pixels does so along an even side, and one of 3 along an odd side. A
// window of 2 along an odd side hangs over the edge in its last place.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The window that lies symmetrically, with stride 2 and `padding::same`, on an image whose sides were halved
/// `halvings` times, rounding up. It has `even` pixels, an even number, along an even side, and one more
/// along an odd side.
[[nodiscard]] constexpr extent2d symmetric_window(std::size_t rows, std::size_t columns, std::size_t even,
                                                  std::size_t halvings) {
    const auto side = [&](std::size_t size) {
        for (std::size_t i = 0; i < halvings; ++i)
            size = (size + 1) / 2;
        return even + size % 2;
    };
    return {side(rows), side(columns)};
}

}} // namespace tactnet
