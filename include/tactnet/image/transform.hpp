#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/kernels/map/affine_sampling.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// Affine transforms of images in one pass.

namespace tactnet { inline namespace TACTNET_ARCH {

/// How values between tactels are interpolated.
enum class interpolation_mode {
    bilinear,
    bicubic ///< Keys' cubic with a = −½
};
/// The pixels outside of the image.
enum class border_mode {
    zero, ///< no contact
    edge  ///< the nearest pixel
};

namespace detail {

/// Copies an image times `gain`, padded so that taps need no bounds check.
template <shape Shape, class Sampling, border_mode Border, class Count>
void pad_image(const Count* from, float gain, float* padded) {
    constexpr std::size_t before = Sampling::before, behind = Sampling::behind;
    for (std::size_t y = 0; y < Shape.rows; ++y) {
        float* const row = padded + (before + y) * Sampling::stride;
        for (std::size_t x = 0; x < Shape.columns; ++x)
            row[before + x] = static_cast<float>(from[y * Shape.columns + x]) * gain;
        std::fill_n(row, before, Border == border_mode::zero ? 0.0f : row[before]);
        std::fill_n(row + before + Shape.columns, behind,
                    Border == border_mode::zero ? 0.0f : row[before + Shape.columns - 1]);
    }
    const auto fill_rows = [&](std::size_t first, std::size_t count, std::size_t like) {
        for (std::size_t y = first; y < first + count; ++y)
            if constexpr (Border == border_mode::zero)
                std::fill_n(padded + y * Sampling::stride, Sampling::stride, 0.0f);
            else
                std::copy_n(padded + like * Sampling::stride, Sampling::stride,
                            padded + y * Sampling::stride);
    };
    fill_rows(0, before, before);
    fill_rows(before + Shape.rows, behind, before + Shape.rows - 1);
}

/// Sets a part of one channel to zero. Its sides are rounded to pixels.
template <shape Shape>
void erase_part(const image_part& part, float* channel) {
    const auto pixel = [](double share, std::size_t pixels) {
        const double within = share > 0 ? std::min(share, 1.0) : 0.0; // of NaN 0
        return static_cast<std::size_t>(within * static_cast<double>(pixels) + 0.5);
    };
    const std::size_t left = pixel(part.column, Shape.columns),
                      right = pixel(part.column + part.columns, Shape.columns);
    for (std::size_t y = pixel(part.row, Shape.rows); y < pixel(part.row + part.rows, Shape.rows); ++y)
        if (left < right)
            std::fill_n(channel + y * Shape.columns + left, right - left, 0.0f);
}

template <shape Shape, interpolation_mode Interpolation, border_mode Border, class Count>
void transform_image(const image_transform& t, const Count* from, float* to) {
    static_assert(Shape.size() > 0,
                  "transform_image: there must be at least one row, one column and one channel");
    if constexpr (Shape.size() > 0) { // avoids further errors
        using sampling = kernels::affine_sampling<Shape.rows, Shape.columns,
                                                  Interpolation == interpolation_mode::bilinear ? 2 : 4>;
        constexpr double middle_row = static_cast<double>(Shape.rows - 1) / 2,
                         middle_column = static_cast<double>(Shape.columns - 1) / 2;
        const kernels::affine_positions positions{t.row_shift + middle_row, t.row_by_row,
                                                  t.row_by_column,          t.column_shift + middle_column,
                                                  t.column_by_row,          t.column_by_column};
        alignas(vector_alignment) std::array<float, sampling::padded_rows * sampling::stride> padded;
        for (std::size_t channel = 0; channel < Shape.channels; ++channel) {
            pad_image<Shape, sampling, Border>(from + channel * Shape.area(), static_cast<float>(t.gain),
                                               padded.data());
            sampling::run(positions, padded.data(), to + channel * Shape.area());
            if (!t.erased.empty())
                erase_part<Shape>(t.erased, to + channel * Shape.area());
        }
    }
}

} // namespace detail

/// Transforms all channels of an image. Positions are in single precision: within 10⁻⁵ of a pixel for images
/// of up to 64 pixels. Pixel-aligned transforms are bit-exact: identity, reflections, translations by whole
/// pixels, half turns, and quarter turns of squares. NaN and infinity reach the outputs that weigh them.
template <shape Shape, interpolation_mode Interpolation = interpolation_mode::bilinear,
          border_mode Border = border_mode::zero>
void transform_image(const image_transform& t, std::span<const std::uint8_t, Shape.size()> from,
                     tensor_view<float, Shape> to) {
    detail::transform_image<Shape, Interpolation, Border>(t, from.data(), to.data());
}
/// Transforms an image of floats. `from` and `to` may be the same.
template <shape Shape, interpolation_mode Interpolation = interpolation_mode::bilinear,
          border_mode Border = border_mode::zero>
void transform_image(const image_transform& t, tensor_view<const float, Shape> from,
                     tensor_view<float, Shape> to) {
    detail::transform_image<Shape, Interpolation, Border>(t, from.data(), to.data());
}

}} // namespace tactnet
