#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/deployment/steps/relu.hpp>
#include <tactnet/layers/relu.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <>
struct deployed_form<relu> {
    static constexpr bool rectifies = true;
    template <class Place>
    using at =
        form_without_parameters<relu_step<typename Place::format, Place::layer::output, Place::input_stride>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
