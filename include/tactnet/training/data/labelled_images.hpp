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

namespace detail {

/// `kind` are "images" of `numbers` "pixels", or what else has labels.
inline void check_labelled(const std::string& kind, const std::string& pixels, std::size_t numbers,
                           std::span<const std::size_t> labels, std::size_t classes, std::size_t size,
                           std::size_t outputs) {
    const auto refuse = [&](const std::string& what, std::size_t expected, std::size_t found) {
        throw std::invalid_argument(kind + ": expected " + what + " " + std::to_string(expected) +
                                    ", found " + std::to_string(found));
    };
    if (classes == 0 || classes > outputs)
        refuse("classes, at least one and at most", outputs, classes);
    if (numbers != labels.size() * size)
        refuse(pixels + ":", labels.size() * size, numbers);
    for (const std::size_t label : labels)
        if (label >= classes)
            refuse("a label below", classes, label);
}

} // namespace detail

/// Throws std::invalid_argument unless a network of so many outputs can tell the classes apart, every label
/// is one of them, and there are as many pixels as the labels need.
inline void check_images(const labelled_images& images, shape size, std::size_t outputs) {
    detail::check_labelled("images", "pixels", images.pixels.size(), images.labels, images.classes,
                           size.size(), outputs);
}
/// For a network.
template <class Network>
void check_images(const labelled_images& images) {
    check_images(images, Network::input_shape, Network::outputs);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
