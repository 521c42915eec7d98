#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/softmax/layer.hpp>
#include <tactnet/operators/softmax/step.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A softmax of the outputs of a lowered layer, in its step. It can only write the outputs of the network.
template <class Lowered>
struct lowered_softmax {
    using step = softmax_not_last<typename Lowered::step>;
    static void fold(const parameter_source& list, float* to) { Lowered::fold(list, to); }
};
template <class Lowered>
    requires requires { typename Lowered::as_output; }
struct lowered_softmax<Lowered> {
    using step = softmax_not_last<typename Lowered::step>;
    struct as_output {
        using step = step_with_softmax<typename Lowered::as_output::step>;
        static void fold(const parameter_source& list, float* to) { Lowered::as_output::fold(list, to); }
    };
    static void fold(const parameter_source& list, float* to) { Lowered::fold(list, to); }
};

template <>
struct lowering<softmax> {
    template <class Lowered>
    using output_fused = lowered_softmax<Lowered>;
    template <class Place>
    using at = lowered_to<softmax_step<typename Place::format, Place::layer::output, Place::input_stride>>;
};

}} // namespace tactnet
