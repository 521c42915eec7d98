#pragma once

#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Images of one size, stored one after the other as 8-bit counts, and the class of each. A view.
struct labelled_images {
    std::span<const std::uint8_t> pixels;
    std::span<const std::size_t> labels;
    std::size_t classes = 0;

    template <shape Shape>
    [[nodiscard]] std::span<const std::uint8_t, Shape.size()> image(std::size_t index) const {
        return std::span<const std::uint8_t, Shape.size()>(pixels.data() + index * Shape.size(),
                                                           Shape.size());
    }
};

/// Throws std::invalid_argument unless a network of so many outputs can tell the classes apart, every label
/// is one of them, and there are as many pixels as the labels need.
inline void check_images(const labelled_images& images, shape size, std::size_t outputs) {
    const auto refuse = [](const std::string& what, std::size_t expected, std::size_t found) {
        throw std::invalid_argument("images: expected " + what + " " + std::to_string(expected) + ", found " +
                                    std::to_string(found));
    };
    if (images.classes == 0 || images.classes > outputs)
        refuse("classes, at least one and at most", outputs, images.classes);
    if (images.pixels.size() != images.labels.size() * size.size())
        refuse("pixels:", images.labels.size() * size.size(), images.pixels.size());
    for (const std::size_t label : images.labels)
        if (label >= images.classes)
            refuse("a label below", images.classes, label);
}
/// For a network.
template <class Network>
void check_images(const labelled_images& images) {
    check_images(images, Network::input_shape, Network::outputs);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
