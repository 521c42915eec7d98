#pragma once

#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Softmax over the channels of each pixel.
template <class Format, shape Map, std::size_t Stride>
struct softmax_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<softmax_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/softmax/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::softmax_step", "Softmax", std::type_identity<Format>{}, Map, input_stride_argument{});
    }
};

template <shape Map, std::size_t Stride>
struct softmax_step<single_precision, Map, Stride> : step_base<single_precision, Map, Stride> {
    static constexpr bool gives_probabilities = true;

    static void run(const float*, const float* in, float* out, float*) noexcept {
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride) {
            kernels::softmax_of<float>(std::span(in + pixel, Map.channels),
                                       std::span(out + pixel, Map.channels));
            std::fill(out + pixel + Map.channels, out + pixel + Stride, 0.0f);
        }
    }
};

/// A step that writes the outputs of a network as floats, with the softmax of these outputs in their place:
/// for number formats whose maps hold something else.
template <class Step>
struct step_with_softmax : Step {
    using activation = typename Step::format::activation;
    static constexpr bool gives_probabilities = true;

    static void run(const typename Step::format::packed_number* packed, const activation* in, activation* out,
                    activation* memory) noexcept {
        Step::run(packed, in, out, memory);
        apply<Step::output_stride>(reinterpret_cast<float*>(out));
    }
    /// For calibration, from outputs to probabilities in their place.
    static void reference(const float*, const float*, float* out) { apply<Step::output.channels>(out); }

private:
    template <std::size_t Stride>
    static void apply(float* outputs) {
        for (std::size_t pixel = 0; pixel < Step::output.area() * Stride; pixel += Stride)
            kernels::softmax_of<float>(std::span<const float>(outputs + pixel, Step::output.channels),
                                       std::span(outputs + pixel, Step::output.channels));
    }
};
template <class Step>
struct step_description<step_with_softmax<Step>> {
    static constexpr const char* header = "tactnet/operators/softmax/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::step_with_softmax", "Softmax of the outputs",
           inner_step<Step, step_composition::wrapper>{""});
    }
};
/// The step for a softmax in the middle of a network, which such a format cannot compute.
template <class Step>
struct softmax_not_last : Step {
    using activation = typename Step::format::activation;

    static void run(const typename Step::format::packed_number*, const activation*, activation*,
                    activation*) noexcept {
        static_assert(Step::output.size() == 0, "deploy: in this number format a softmax must be the last "
                                                "layer: maps in front of others hold no probabilities");
    }
};

}} // namespace tactnet
