#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/softmax.hpp>
#include <tactnet/layers/softmax.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A form whose outputs become probabilities, where it writes those of the network.
template <class Lowered>
struct lowered_softmax {
    using step = softmax_not_last<typename Lowered::step>;
    static void fold(const parameter_source& list, float* to) { Lowered::fold(list, to); }
};
/// The same of a form that can write the outputs of a network.
template <class Lowered>
    requires requires {
        typename Lowered::as_output;
    }
struct lowered_softmax<Lowered> {
    /// Where others follow.
    using step = softmax_not_last<typename Lowered::step>;
    /// Where none follows.
    struct as_output {
        /// What the form does there, and the softmax.
        using step = step_with_softmax<typename Lowered::as_output::step>;
        /// As the form itself.
        static void fold(const parameter_source& list, float* to) { Lowered::as_output::fold(list, to); }
    };
    /// As the form itself.
    static void fold(const parameter_source& list, float* to) { Lowered::fold(list, to); }
};

template <>
struct lowering<softmax> {
    /// See deployment/lowering/lowering.hpp.
    template <class Lowered>
    using output_fused = lowered_softmax<Lowered>;
    template <class Place>
    using at = lowered_to<softmax_step<typename Place::format, Place::layer::output, Place::input_stride>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
