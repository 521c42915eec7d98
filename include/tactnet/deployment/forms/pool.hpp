#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/deployment/steps/pool.hpp>
#include <tactnet/layers/max_pool.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <extent Window, extent Stride, padding Padding>
struct deployed_form<max_pool<Window, Stride, Padding>> {
    template <class Place>
    static constexpr sliding_window maximum = Place::layer::window;
    template <class Place>
    using at =
        form_without_parameters<pool_step<typename Place::format, Place::layer::window, Place::input_stride>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
