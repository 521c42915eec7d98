#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/deployment/steps/average_pool.hpp>
#include <tactnet/layers/average_pool.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Place>
struct average_pool_form
    : form_without_parameters<average_pool_step<typename Place::format, Place::layer::windows,
                                                Place::layer::output.channels, Place::input_stride>> {
    using leaving = average_pool_form<typename Place::leaving>;
};

template <extent Window, extent Stride, padding Padding, average_over Over>
struct deployed_form<average_pool<Window, Stride, Padding, Over>> {
    template <class Place>
    using at = average_pool_form<Place>;
};
template <extent Output>
struct deployed_form<adaptive_average_pool<Output>> {
    template <class Place>
    using at = average_pool_form<Place>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
