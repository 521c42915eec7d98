#pragma once

#include <tactnet/tensor/tensor.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Turns 8-bit counts into the input of a network: (count − mean) × scale. The mean is an image, in the paper
/// that of the training set; a mean of zero and a scale of 1/255 give plain scaling.
template <shape Shape>
struct normalisation {
    tensor<float, Shape> mean{};
    float scale = 1;

    /// The mean over contiguous images, summed in integers without rounding errors.
    [[nodiscard]] static tensor<float, Shape> mean_of(std::span<const std::uint8_t> images,
                                                      std::span<const std::size_t> chosen) {
        tensor<float, Shape> result;
        for (std::size_t e = 0; e < Shape.size() && !chosen.empty(); ++e) {
            std::uint64_t sum = 0;
            for (const std::size_t image : chosen)
                sum += images[image * Shape.size() + e];
            result.data()[e] =
                static_cast<float>(static_cast<double>(sum) / static_cast<double>(chosen.size()));
        }
        return result;
    }

    /// Normalises counts, as stored or augmented, in place.
    void apply(tensor_view<float, Shape> image) const {
        for (std::size_t e = 0; e < Shape.size(); ++e)
            image.data()[e] = (image.data()[e] - mean.data()[e]) * scale;
    }
    /// Returns the normalised counts.
    [[nodiscard]] tensor<float, Shape> apply(std::span<const std::uint8_t, Shape.size()> counts) const {
        tensor<float, Shape> result;
        for (std::size_t e = 0; e < Shape.size(); ++e)
            result.data()[e] = static_cast<float>(counts[e]);
        apply(result.view());
        return result;
    }
};

}} // namespace tactnet
