#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/activations/step.hpp>

#include <algorithm>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The lowering of activation functions.
template <class Function>
struct lowered_function {
    static constexpr bool rectifies = detail::is_relu<Function>();
    template <class Place>
    static constexpr bool in_stream = !Place::reads_frame;
    template <class Place>
    using at =
        lowered_to<activation_step<typename Place::format, Function, Place::output, Place::input_stride>>;
};
template <class Function>
struct lowering<activation<Function>> : lowered_function<Function> {};
template <class Function>
    requires fusible_activation<Function>
struct lowering<activation<Function>> : lowered_function<Function> {
    static constexpr const kernels::fused_activation* activation = fused<Function>;
};

/// A parametric ReLU: its slopes.
template <class Place>
struct lowered_parametric_relu {
    using step = parametric_relu_step<typename Place::format, Place::layer::output, Place::input_stride>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(Place::parameters(list).values, Place::layer::channels, to);
    }
};
template <>
struct lowering<parametric_relu> {
    template <class Place>
    using at = lowered_parametric_relu<Place>;
};

template <class Offset>
struct lowering<square_root<Offset>> {
    // A fraction in lowest terms, so that equal ones are one step with one spelling.
    template <class Place>
    using at = lowered_to<square_root_step<typename Place::format, Place::layer::output, Place::input_stride,
                                           typename Offset::type>>;
};

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

template <unsigned Percent>
struct lowering<dropout<Percent>> {
    static constexpr bool inference_no_op = true;
};

}} // namespace tactnet
