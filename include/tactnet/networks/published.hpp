#pragma once

#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <optional>

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

/// The resolutions of the paper. The array has 28 × 50 tactels; the other images are resized.
enum class published_resolution { r28x50, r20x35, r14x25, r10x18, r7x13 };

/// The resolution whose form a network has at any size: the smallest that is at least as large in both
/// directions, or the full one for larger images. At a published size it is that size.
[[nodiscard]] constexpr published_resolution published_resolution_of(shape image) {
    const auto within = [&](std::size_t rows, std::size_t columns) {
        return image.rows <= rows && image.columns <= columns;
    };
    return within(7, 13)    ? published_resolution::r7x13
           : within(10, 18) ? published_resolution::r10x18
           : within(14, 25) ? published_resolution::r14x25
           : within(20, 35) ? published_resolution::r20x35
                            : published_resolution::r28x50;
}

/// Whether an image is within the sizes of the paper: from 7 × 13 to 28 × 50 tactels, in either orientation.
/// The accuracy of networks outside this range is unknown.
[[nodiscard]] constexpr bool within_published_range(shape image) {
    const auto within = [](std::size_t rows, std::size_t columns) {
        return rows >= 7 && columns >= 13 && rows <= 28 && columns <= 50;
    };
    return within(image.rows, image.columns) || within(image.columns, image.rows);
}

template <std::size_t Rows, std::size_t Columns, std::size_t LeastRows, std::size_t LeastColumns>
concept image_is_large_enough = (Rows >= LeastRows) && (Columns >= LeastColumns);

namespace detail {

/// Passes the number of classes on, and rejects images smaller than the first kernel of the paper's networks,
/// which would see more padding than image. (GCC 12 cannot use a function of the shape in a list of layers.)
template <std::size_t Rows, std::size_t Columns, std::size_t Classes>
struct classes_on {
    static_assert(
        image_is_large_enough<Rows, Columns, 5, 5>,
        "tactnet4, tactnet6, tactresnet: the image is smaller than the first kernel of 5 x 5 tactels; "
        "image_is_large_enough shows its rows and columns, then the least");
    static constexpr std::size_t count = Classes;
};

} // namespace detail

/// Settings for fine-tuning a network that was trained on photographs (the paper's TL-NN).
struct published_transfer {
    std::size_t epochs, batch;
    double new_layer_factor; ///< rate of the new last layer, in rates of the others
};

/// The published settings of the training of one network; recipe::published adds the common ones.
struct published_training {
    double rate;                     ///< first learning rate, of a new last layer
    double drop_period;              ///< epochs after which the rate is multiplied by drop_factor; 0 is never
    std::size_t patience;            ///< validations without a smaller loss before it stops
    double drop_factor = 0.1;        ///< of the rate, each time
    std::size_t validate_every = 10; ///< epochs
    bool subtracts_mean = true;      ///< of the training images; else the input are counts
    std::optional<published_transfer> transfer = {};
};

}} // namespace tactnet
