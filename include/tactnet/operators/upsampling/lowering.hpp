#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/upsampling/layer.hpp>
#include <tactnet/operators/upsampling/step.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The lowering of layers that resample a map.
template <class Place, class Layer = typename Place::layer>
using lowered_resampling =
    lowered_to<resampling_step<typename Place::format, Layer::mode, Layer::input,
                               extent2d(Layer::output.rows, Layer::output.columns), Place::input_stride>>;

template <extent2d Factor, interpolation Mode>
struct lowering<upsample<Factor, Mode>> {
    template <class Place>
    using at = lowered_resampling<Place>;
};
template <extent2d Size, interpolation Mode>
struct lowering<upsample_to<Size, Mode>> {
    template <class Place>
    using at = lowered_resampling<Place>;
};

}} // namespace tactnet
