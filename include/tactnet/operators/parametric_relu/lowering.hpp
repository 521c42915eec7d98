#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/parametric_relu/layer.hpp>
#include <tactnet/operators/parametric_relu/step.hpp>

#include <algorithm>

namespace tactnet { inline namespace TACTNET_ARCH {

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

}} // namespace tactnet
