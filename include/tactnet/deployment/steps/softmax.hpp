#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/rows/softmax.hpp>

#include <algorithm>
#include <cstddef>
#include <span>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Softmax over the channels of each pixel.
template <class Format, shape Map, std::size_t Stride>
struct softmax_step;

template <shape Map, std::size_t Stride>
struct softmax_step<single_precision, Map, Stride> : step_without_parameters<single_precision, Map, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride) {
            kernels::softmax_of<float>(std::span(in + pixel, Map.channels),
                                       std::span(out + pixel, Map.channels));
            std::fill(out + pixel + Map.channels, out + pixel + Stride, 0.0f);
        }
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
