#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/resize.hpp>
#include <tactnet/image/transform.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

template <shape Taken, shape Seen>
void vary_and_reduce(const image_transform& t, const std::uint8_t* from, float* to) {
    alignas(alignment) std::array<float, Taken.size()> varied;
    transform_image<Taken>(t, std::span<const std::uint8_t, Taken.size()>(from, Taken.size()),
                           tensor_view<float, Taken>(varied.data()));
    resize<Taken, Seen>(tensor_view<const float, Taken>(varied.data()), tensor_view<float, Seen>(to));
    for (std::size_t e = 0; e < Seen.size(); ++e) // the cubic overshoots, counts do not
        to[e] = std::clamp(to[e], 0.0f, 255.0f);
}

} // namespace detail

/// The images of which others were made by reducing them. A touch that is moved by half a tactel of a small
/// image, or turned by some degrees, gives another image, which cannot be made of the small one: to learn
/// from small images, vary what the sensor gave, and reduce that. A view.
///
///     labelled_images{small, labels, 22, images_as_taken::of<shape{28, 50}, shape{7, 13}>(large)}
struct images_as_taken {
    /// Writes what an image looks like after a transformation, reduced.
    using variation = void (*)(const image_transform&, const std::uint8_t* from, float* to);

    std::span<const std::uint8_t> pixels{}; ///< one image after the other, in the order of the small ones
    shape taken{}, seen{};                  ///< before and after they are reduced
    variation vary = nullptr;               ///< null where nothing is known of larger images

    /// Reduced as by `resize`: bicubically, against aliasing.
    template <shape Taken, shape Seen>
    [[nodiscard]] static images_as_taken of(std::span<const std::uint8_t> pixels) {
        return {pixels, Taken, Seen, &detail::vary_and_reduce<Taken, Seen>};
    }
    /// Whether larger images are known.
    [[nodiscard]] bool given() const { return vary != nullptr; }
    /// How many tactels lie where there is one in the small images, in the direction where there are more.
    [[nodiscard]] double tactels_for_one() const {
        return std::max(static_cast<double>(taken.rows) / static_cast<double>(seen.rows),
                        static_cast<double>(taken.columns) / static_cast<double>(seen.columns));
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
