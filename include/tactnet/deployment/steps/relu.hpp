#pragma once

#include <tactnet/deployment/steps/step.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A ReLU that follows neither a convolution nor a batch norm.
template <class Format, shape Map, std::size_t Stride>
struct relu_step;

template <shape Map, std::size_t Stride>
struct relu_step<single_precision, Map, Stride> : step_without_parameters<single_precision, Map, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        for (std::size_t e = 0; e < Map.area() * Stride; ++e)
            out[e] = in[e] < 0 ? 0 : in[e];
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
