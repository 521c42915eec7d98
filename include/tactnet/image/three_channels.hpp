#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>
#include <tactnet/tensor/batch.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <array>
#include <cstddef>
#include <span>

// Converts a grey image to the three normalised channels that networks trained on photographs take (the
// paper's equation 4).

namespace tactnet { inline namespace TACTNET_ARCH {

/// (value − mean) × scale, channel by channel.
struct channel_normalisation {
    std::array<float, 3> mean{};
    std::array<float, 3> scale{1, 1, 1};
};

/// The shape of a grey image with three channels.
[[nodiscard]] constexpr shape with_three_channels(shape grey) {
    return {grey.rows, grey.columns, 3};
}

/// Writes one channel after the other, the layout of tensors.
template <shape Grey>
[[gnu::flatten]] void to_three_channels(tensor_view<const float, Grey> grey,
                                        const channel_normalisation& normalise,
                                        tensor_view<float, with_three_channels(Grey)> to) {
    static_assert(Grey.channels == 1, "to_three_channels: expected an image of one channel");
    constexpr std::size_t width = kernels::lanes_for<float>(Grey.area());
    using wide = kernels::sized_vector<float, width>;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const float mean = normalise.mean[channel], scale = normalise.scale[channel];
        float* const plane = to.data() + channel * Grey.area();
        if constexpr (Grey.area() < width)
            for (std::size_t e = 0; e < Grey.area(); ++e)
                plane[e] = (grey.data()[e] - mean) * scale;
        else
            for (std::size_t v = 0; v < kernels::row_vectors(Grey.area(), width); ++v) {
                const std::size_t begin = kernels::row_vector_begin(v, Grey.area(), width);
                kernels::store_anywhere(plane + begin,
                                        (kernels::load_unaligned<wide>(grey.data() + begin) - wide(mean)) *
                                            wide(scale));
            }
    }
}

/// Writes the three channels of a pixel side by side, the layout of deployed networks and most image files.
template <shape Grey>
[[gnu::flatten]] void to_three_channels_last(tensor_view<const float, Grey> grey,
                                             const channel_normalisation& normalise,
                                             std::span<float, 3 * Grey.area()> to) {
    static_assert(Grey.channels == 1, "to_three_channels_last: expected an image of one channel");
    constexpr std::size_t width = kernels::lanes_for<float>(Grey.area()), whole = Grey.area() / width * width;
    using wide = kernels::sized_vector<float, width>;
    alignas(vector_alignment) std::array<float, 3 * width> means, scales;
    for (std::size_t i = 0; i < 3 * width; ++i)
        means[i] = normalise.mean[i % 3], scales[i] = normalise.scale[i % 3];
    for (std::size_t begin = 0; begin < whole; begin += width) {
        const auto values = kernels::repeat_three(kernels::load_unaligned<wide>(grey.data() + begin));
        kernels::unroll<3>([&](auto i) {
            kernels::store_anywhere(to.data() + 3 * begin + i * width,
                                    (values[i] - kernels::load_as<wide>(means.data() + i * width)) *
                                        kernels::load_as<wide>(scales.data() + i * width));
        });
    }
    for (std::size_t i = 3 * whole; i < 3 * Grey.area(); ++i)
        to[i] = (grey.data()[i / 3] - normalise.mean[i % 3]) * normalise.scale[i % 3];
}

/// Writes one sample of a batch, for training.
template <shape Grey, std::size_t Lanes>
void to_three_channels(tensor_view<const float, Grey> grey, const channel_normalisation& normalise,
                       batch_view<float, with_three_channels(Grey), Lanes> to, std::size_t sample) {
    static_assert(Grey.channels == 1, "to_three_channels: expected an image of one channel");
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t e = 0; e < Grey.area(); ++e)
            to(sample, channel * Grey.area() + e) =
                (grey.data()[e] - normalise.mean[channel]) * normalise.scale[channel];
}

}} // namespace tactnet
