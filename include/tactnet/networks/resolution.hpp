#pragma once

#include <tactnet/tensor/shape.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The resolutions of the paper. The array itself has 28 × 50 tactels; the others are made from it by
/// resizing.
enum class resolution { r28x50, r20x35, r14x25, r10x18, r7x13 };

/// The form of a network at any size: that of the smallest published resolution which holds the size in both
/// directions; larger ones take the full form. At a published size this is the published form.
[[nodiscard]] constexpr resolution form_of(shape image) {
    const auto within = [&](std::size_t rows, std::size_t columns) {
        return image.rows <= rows && image.columns <= columns;
    };
    return within(7, 13)    ? resolution::r7x13
           : within(10, 18) ? resolution::r10x18
           : within(14, 25) ? resolution::r14x25
           : within(20, 35) ? resolution::r20x35
                            : resolution::r28x50;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
