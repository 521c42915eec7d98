#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/image/three_channels.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor_view.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Turns a pressure image into the photograph that an ImageNet network expects: resized bicubically, its
// channel repeated three times (the paper's equations 1 to 4), normalised as in the training of the weights.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The value of a resized pixel before it is normalised.
enum class resized_pixel {
    count, ///< rounded and clamped to 0 … 255, as MATLAB's imresize does with 8-bit images
    number ///< the result of the bicubic kernel
};

/// The preprocessing that weights were trained with. Values are counts, 0 … 255.
struct photograph_preprocessing {
    channel_normalisation normalise; ///< of red, green and blue
    resized_pixel pixel = resized_pixel::count;
};

/// The preprocessing of torchvision's weights: mean and standard deviation of ImageNet's channels, which
/// torchvision states for values of 0 … 1.
inline constexpr photograph_preprocessing torchvision_photograph{
    {.mean = {0.485F * 255, 0.456F * 255, 0.406F * 255},
     .scale = {1 / (0.229F * 255), 1 / (0.224F * 255), 1 / (0.225F * 255)}},
    resized_pixel::count};

/// The preprocessing of weights that descend from Caffe, such as MATLAB's: only the mean is subtracted.
[[nodiscard]] constexpr photograph_preprocessing mean_photograph(float red, float green, float blue) {
    return {{.mean = {red, green, blue}, .scale = {1, 1, 1}}, resized_pixel::count};
}

namespace detail {

/// Fills all three channels of a photograph from its first, and normalises them.
inline void spread_first_channel(std::span<float> photograph, const channel_normalisation& normalise) {
    const std::size_t area = photograph.size() / 3;
    // The first channel comes last, since all are computed from it.
    for (std::size_t channel = 3; channel-- > 0;) {
        const float mean = normalise.mean[channel], scale = normalise.scale[channel];
        const auto plane = photograph.subspan(channel * area, area);
        for (std::size_t e = 0; e < area; ++e)
            plane[e] = (photograph[e] - mean) * scale;
    }
}

} // namespace detail

/// Turns an image of compile-time size into a photograph. Uses no heap: the first channel of `to` is its
/// buffer.
template <shape Grey, shape Photograph>
void to_photograph(tensor_view<const std::uint8_t, Grey> image, const photograph_preprocessing& form,
                   tensor_view<float, Photograph> to) {
    static_assert(Grey.channels == 1 && Photograph.channels == 3,
                  "to_photograph: expected an image of one channel, and room for three");
    constexpr shape resized{Photograph.rows, Photograph.columns, 1};
    resize<Grey, resized>(image, tensor_view<float, resized>(to.data()));
    if (form.pixel == resized_pixel::count)
        for (std::size_t e = 0; e < resized.size(); ++e)
            to.data()[e] = static_cast<float>(saturate_to_count(to.data()[e]));
    detail::spread_first_channel(to.elements(), form.normalise);
}

/// Turns an image whose size is known at run time into a photograph. It resizes in double precision: rounded
/// pixels may differ by one count from those of the overload above. `to` is ordered [channel][row][column].
/// Throws std::invalid_argument for an empty image, and if a span does not have the length of its size.
inline void to_photograph(std::span<const std::uint8_t> image, extent2d grey,
                          const photograph_preprocessing& form, extent2d photograph, std::span<float> to) {
    const std::size_t area = photograph.area();
    if (to.size() != 3 * area)
        detail::throw_invalid_argument(
            {"to_photograph: expected room for ", 3 * area, " numbers, found ", to.size()});
    const auto first = to.first(area);
    if (form.pixel == resized_pixel::count) {
        const auto counts =
            resize_bicubic(image, grey.rows, grey.columns, photograph.rows, photograph.columns);
        std::copy(counts.begin(), counts.end(), first.begin());
    } else {
        const std::vector<float> numbers(image.begin(), image.end());
        const auto resized = resize_bicubic(std::span<const float>(numbers), grey.rows, grey.columns,
                                            photograph.rows, photograph.columns);
        std::copy(resized.begin(), resized.end(), first.begin());
    }
    detail::spread_first_channel(to, form.normalise);
}

}} // namespace tactnet
