#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/image/three_channels.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

// A pressure image as the photograph that a network trained on ImageNet expects: resized bicubically, its
// channel three times (the paper's equations 1 to 4), normalised as the weights want it.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What a resized pixel is before it is normalised.
enum class resized_pixel {
    count, ///< rounded and kept within 0 … 255, as MATLAB's imresize does with 8-bit images
    number ///< as the bicubic kernel gives it
};

/// What weights were trained with. Values are counts, 0 … 255.
struct photograph_form {
    channel_normalisation normalise; ///< of red, green and blue
    resized_pixel pixel = resized_pixel::count;
};

/// Of torchvision's weights: mean and standard deviation of ImageNet's channels, there given for 0 … 1.
inline constexpr photograph_form torchvision_photograph{
    {.mean = {0.485F * 255, 0.456F * 255, 0.406F * 255},
     .scale = {1 / (0.229F * 255), 1 / (0.224F * 255), 1 / (0.225F * 255)}},
    resized_pixel::count};

/// Of weights in the line of Caffe, such as MATLAB's: the mean of each channel is subtracted, no more.
[[nodiscard]] constexpr photograph_form mean_photograph(float red, float green, float blue) {
    return {{.mean = {red, green, blue}, .scale = {1, 1, 1}}, resized_pixel::count};
}

namespace detail {

/// From the first channel of a photograph to all three, normalised.
inline void spread_first_channel(std::span<float> photograph, const channel_normalisation& normalise) {
    const std::size_t area = photograph.size() / 3;
    // The first comes last, since all are made from it.
    for (std::size_t channel = 3; channel-- > 0;) {
        const float mean = normalise.mean[channel], scale = normalise.scale[channel];
        const auto plane = photograph.subspan(channel * area, area);
        for (std::size_t e = 0; e < area; ++e)
            plane[e] = (photograph[e] - mean) * scale;
    }
}

} // namespace detail

/// `to` is [channel][row][column]. No heap and little stack: its own first channel is used on the way.
template <shape Grey, shape Photograph>
void to_photograph(tensor_view<const std::uint8_t, Grey> image, const photograph_form& form,
                   tensor_view<float, Photograph> to) {
    static_assert(Grey.channels == 1 && Photograph.channels == 3,
                  "to_photograph: expected an image of one channel, and room for three");
    constexpr shape resized{Photograph.rows, Photograph.columns, 1};
    resize<Grey, resized>(image, tensor_view<float, resized>(to.data()));
    if (form.pixel == resized_pixel::count)
        for (std::size_t e = 0; e < resized.size(); ++e)
            to.data()[e] = static_cast<float>(to_count(to.data()[e]));
    detail::spread_first_channel(to.elements(), form.normalise);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
