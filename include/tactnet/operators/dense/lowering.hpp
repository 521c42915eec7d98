#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/dense/layer.hpp>
#include <tactnet/operators/dense/step.hpp>
#include <tactnet/operators/temporal/lowering.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The lowering of a fully connected layer.
template <class Place>
struct lowered_dense {
    using layer = typename Place::layer;
    using step = dense_step<typename Place::format,
                            kernels::frame_dense{layer::input, Place::input_stride, layer::output.channels}>;

    using as_output = lowered_dense<typename Place::as_output>;

    static void fold(const parameter_source& list, float* to) {
        std::copy_n(Place::parameters(list).values, layer::parameters, to);
    }
};

/// In a stream it comes after last_frame, and its sums have the bits of the layer in a batch.
template <std::size_t Outputs>
struct lowering<dense<Outputs>> {
    template <class Place>
    static constexpr bool in_stream = Place::layer::input.area() == 1;
    template <class Place>
    using at =
        std::conditional_t<Place::in_stream, lowered_causal<Place, Outputs, 1, 1>, lowered_dense<Place>>;
};

}} // namespace tactnet
