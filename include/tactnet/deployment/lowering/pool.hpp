#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/pool.hpp>
#include <tactnet/layers/max_pool.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <extent2d Window, extent2d Stride, padding Padding>
struct lowering<max_pool<Window, Stride, Padding>> {
    template <class Place>
    static constexpr sliding_window maximum = Place::layer::window;
    template <class Place>
    using at = lowered_to<pool_step<typename Place::format, Place::layer::window, Place::input_stride>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
