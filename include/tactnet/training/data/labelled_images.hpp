#pragma once

#include <tactnet/tensor/shape.hpp>
#include <tactnet/training/data/images_as_taken.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Images of one size, stored one after the other as 8-bit counts, and the class of each. A view.
struct labelled_images {
    std::span<const std::uint8_t> pixels;
    std::span<const std::size_t> labels;
    std::size_t classes = 0;
    images_as_taken taken{}; ///< of which they were made, if they were

    template <shape Shape>
    [[nodiscard]] std::span<const std::uint8_t, Shape.size()> image(std::size_t index) const {
        return std::span<const std::uint8_t, Shape.size()>(pixels.data() + index * Shape.size(),
                                                           Shape.size());
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
