#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/dense.hpp>
#include <tactnet/layers/dense.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Place>
struct lowered_dense {
    using layer = typename Place::layer;
    using step = dense_step<typename Place::format,
                            kernels::frame_dense{layer::input, Place::input_stride, layer::output.channels}>;

    using as_output = lowered_dense<typename Place::as_output>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(Place::parameters(list).values, layer::parameters, to);
    }
};

template <std::size_t Outputs>
struct lowering<dense<Outputs>> {
    template <class Place>
    using at = lowered_dense<Place>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
