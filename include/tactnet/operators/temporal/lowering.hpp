#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/temporal/layer.hpp>
#include <tactnet/operators/temporal/step.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A recurrent layer in a stream. Where a format folds parameters in an order of its own, the step does.
template <class Place, class Cell, std::size_t Hidden>
struct lowered_recurrent {
    using step = recurrent_step<typename Place::format, Cell, Place::input.channels, Hidden>;
    using as_output = lowered_recurrent<typename Place::as_output, Cell, Hidden>;

    static void fold(const parameter_source& list, float* to) {
        const float* const values = Place::parameters(list).values;
        if constexpr (requires { step::fold(values, to); })
            step::fold(values, to);
        else
            std::copy_n(values, step::folded_elements, to);
    }
};

template <class Cell, std::size_t Hidden>
struct lowering<recurrent<Cell, Hidden>> {
    template <class>
    static constexpr bool in_stream = true;
    template <class Place>
    using at = lowered_recurrent<Place, Cell, Hidden>;
};

/// In a stream the last frame is the present one.
template <>
struct lowering<last_frame> {
    static constexpr bool inference_no_op = true;
};

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
