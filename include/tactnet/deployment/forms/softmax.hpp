#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/deployment/steps/softmax.hpp>
#include <tactnet/layers/softmax.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <>
struct deployed_form<softmax> {
    template <class Place>
    using at = form_without_parameters<
        softmax_step<typename Place::format, Place::layer::output, Place::input_stride>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
