#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/activations/step.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The lowering of activation functions.
template <class Function>
struct lowered_function {
    static constexpr bool rectifies = detail::is_relu<Function>();
    template <class Place>
    using at = lowered_to<
        activation_step<typename Place::format, Function, Place::layer::output, Place::input_stride>>;
};
template <class Function>
struct lowering<activation<Function>> : lowered_function<Function> {};
template <class Function>
    requires fusible_activation<Function>
struct lowering<activation<Function>> : lowered_function<Function> {
    static constexpr const kernels::fused_activation* activation = fused<Function>;
};

}} // namespace tactnet
