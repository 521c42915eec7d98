#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/causal_convolution/layer.hpp>
#include <tactnet/operators/causal_convolution/step.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A causal convolution in a stream with the ReLU after it; with one tap a dense layer.
template <class Place, std::size_t Filters, std::size_t Taps, std::size_t Dilation, bool Rectified = false>
struct lowered_causal {
    using step =
        causal_step<typename Place::format, Place::input.channels, Filters, Taps, Dilation, Rectified>;
    using as_output = lowered_causal<typename Place::as_output, Filters, Taps, Dilation, Rectified>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(Place::parameters(list).values, Place::layer::parameters, to);
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        if constexpr (Rectified)
            return not_fused{};
        else
            return fuse_relu<Spec, lowered_causal<Place, Filters, Taps, Dilation, true>>();
    }
};

template <std::size_t Filters, std::size_t Taps, std::size_t Dilation>
struct lowering<causal_conv1d<Filters, Taps, Dilation>> {
    template <class>
    static constexpr bool in_stream = true;
    template <class Place>
    using at = lowered_causal<Place, Filters, Taps, Dilation>;
};

}} // namespace tactnet
