#pragma once

#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <optional>

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

/// Whether an image is as large as those of the paper: from 7 × 13 to 28 × 50 tactels, either way up. Of
/// networks outside this range nobody knows how well they recognise: larger ones take the full form, smaller
/// ones that of 7 × 13.
[[nodiscard]] constexpr bool within_published_range(shape image) {
    const auto within = [](std::size_t rows, std::size_t columns) {
        return rows >= 7 && columns >= 13 && rows <= 28 && columns <= 50;
    };
    return within(image.rows, image.columns) || within(image.columns, image.rows);
}

template <std::size_t Rows, std::size_t Columns, std::size_t LeastRows, std::size_t LeastColumns>
concept image_is_large_enough = (Rows >= LeastRows) && (Columns >= LeastColumns);

namespace detail {

/// How many classes the paper's networks tell apart on an image: as many as are asked for, if it is not
/// smaller than the kernel with which they begin; of a smaller one, less would be seen than of padding. (A
/// class, and not a function of the shape, with which GCC 12 does not cope in a list of layers.)
template <std::size_t Rows, std::size_t Columns, std::size_t Classes>
struct classes_on {
    static_assert(
        image_is_large_enough<Rows, Columns, 5, 5>,
        "tactnet4, tactnet6, tactresnet: the image is smaller than the first kernel of 5 x 5 tactels; "
        "image_is_large_enough shows its rows and columns, then the least");
    static constexpr std::size_t count = Classes;
};

} // namespace detail

/// Of a network whose weights were learnt from photographs and are trained on (the paper's TL-NN).
struct published_transfer {
    std::size_t epochs, batch;
    double new_layer_factor; ///< how many times the rate of the others the new last layer learns by
};

/// What a network's published training has of its own. All else is common: see recipe::published, which takes
/// this.
struct published_training {
    double rate;                     ///< first learning rate, that of a new last layer
    double drop_period;              ///< epochs after which the rate is multiplied by drop_factor; 0 is never
    std::size_t patience;            ///< validations without a smaller loss before it stops
    double drop_factor = 0.1;        ///< of the rate, each time
    std::size_t validate_every = 10; ///< epochs
    bool subtracts_mean = true;      ///< of the training images; else counts come as they are
    std::optional<published_transfer> transfer = {};
};

} // namespace TACTNET_ARCH
} // namespace tactnet
