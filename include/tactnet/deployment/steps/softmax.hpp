#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/rows/operations.hpp>

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

/// A step that writes the outputs of a network as floats, and the softmax of these in their place: for number
/// formats whose maps hold something else.
template <class Step>
struct step_with_softmax : Step {
    using activation = typename Step::format::activation;

    static void run(const typename Step::format::packed* packed, const activation* in, activation* out,
                    activation* memory) noexcept {
        Step::run(packed, in, out, memory);
        auto* const outputs = reinterpret_cast<float*>(out);
        for (std::size_t pixel = 0; pixel < Step::output.area() * Step::output_stride;
             pixel += Step::output_stride)
            kernels::softmax_of<float>(std::span<const float>(outputs + pixel, Step::output.channels),
                                       std::span(outputs + pixel, Step::output.channels));
    }
};
/// The same step where others follow.
template <class Step>
struct softmax_not_last : Step {
    using activation = typename Step::format::activation;

    static void run(const typename Step::format::packed*, const activation*, activation*,
                    activation*) noexcept {
        static_assert(Step::output.size() == 0, "deploy: in this number format a softmax must be the last "
                                                "layer: maps in front of others hold no probabilities");
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
