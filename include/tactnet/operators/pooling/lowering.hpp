#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/pooling/layer.hpp>
#include <tactnet/operators/pooling/step.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The lowering of max pools.
template <class Place>
using lowered_max_pool =
    lowered_to<pool_step<typename Place::format, Place::layer::window, Place::input_stride>>;

template <extent2d Window, extent2d Stride, padding Padding>
struct lowering<max_pool<Window, Stride, Padding>> {
    template <class Place>
    static constexpr sliding_window maximum = Place::layer::window;
    template <class Place>
    using at = lowered_max_pool<Place>;
};
template <>
struct lowering<global_max_pool> {
    template <class Place>
    using at = lowered_max_pool<Place>;
};

/// Equal bins are the windows of a max pool, which a convolution may fuse.
template <extent2d Output>
struct lowering<adaptive_max_pool<Output>> {
    template <class Place>
        requires(Place::layer::equal_bins)
    static constexpr sliding_window maximum = [] {
        constexpr shape input = Place::layer::input;
        constexpr extent2d bin(input.rows / Output.rows, input.columns / Output.columns);
        return sliding_window{input, bin, bin};
    }();
    template <class Place>
    struct at : lowered_to<adaptive_max_pool_step<typename Place::format, Place::layer::input, Output,
                                                  Place::input_stride>> {};
    template <class Place>
        requires(Place::layer::equal_bins)
    struct at<Place> : lowered_to<pool_step<typename Place::format, maximum<Place>, Place::input_stride>> {};
};

/// The lowering of average pools.
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
