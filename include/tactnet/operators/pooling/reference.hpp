#pragma once

#include <tactnet/operators/pooling/eight_bit.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <shape Input, extent2d Output, std::size_t Stride>
void resampling_step<eight_bit, interpolation::bilinear, Input, Output, Stride>::reference(const float*,
                                                                                           const float* in,
                                                                                           float* out) {
    for (const auto& above : down::table)
        for (const auto& beside : along::table)
            for (std::size_t c = 0; c < Input.channels; ++c) {
                double sum = 0;
                for (std::size_t y = 0; y < down::taps; ++y)
                    for (std::size_t x = 0; x < along::taps; ++x) {
                        const std::size_t pixel = (above.first + y) * Input.columns + beside.first + x;
                        sum += above.weights[y] * beside.weights[x] *
                               static_cast<double>(in[pixel * Input.channels + c]);
                    }
                *out++ = static_cast<float>(sum);
            }
}

}} // namespace tactnet
