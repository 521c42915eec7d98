#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/deployment/steps/dense.hpp>
#include <tactnet/layers/dense.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Place>
struct dense_form {
    using layer = typename Place::layer;
    using step = dense_step<typename Place::format,
                            kernels::frame_dense{layer::input, Place::input_stride, layer::output.channels}>;

    using leaving = dense_form<typename Place::leaving>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(Place::parameters(list).values, layer::parameters, to);
    }
};

template <std::size_t Outputs>
struct deployed_form<dense<Outputs>> {
    template <class Place>
    using at = dense_form<Place>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
