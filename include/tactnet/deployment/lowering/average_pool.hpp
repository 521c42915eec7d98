#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/average_pool.hpp>
#include <tactnet/layers/average_pool.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Place>
struct lowered_average_pool
    : lowered_to<average_pool_step<typename Place::format, Place::layer::windows,
                                   Place::layer::output.channels, Place::input_stride>> {
    using as_output = lowered_average_pool<typename Place::as_output>;
};

template <extent2d Window, extent2d Stride, padding Padding, average_over Over>
struct lowering<average_pool<Window, Stride, Padding, Over>> {
    template <class Place>
    using at = lowered_average_pool<Place>;
};
template <extent2d Output>
struct lowering<adaptive_average_pool<Output>> {
    template <class Place>
    using at = lowered_average_pool<Place>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
