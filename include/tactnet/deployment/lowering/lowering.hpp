#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/layers/layer.hpp>

#include <concepts>
#include <cstddef>
#include <type_traits>

// What a layer becomes when a network is deployed is said by a trait of its specification, in a file beside
// this one or in the program of whoever wrote the layer:
//
//     template <>
//     struct tactnet::lowering<my_layer> {
//         template <class Place>
//         using at = tactnet::lowered_to<my_step<typename Place::format, …>>;
//     };
//
// `at` is the form of the layer at its place in a list: `step`, what it does (deployment/steps/step.hpp), and
// `fold(list, to)`, which makes the step's folded numbers from the parameters of the list, in double
// precision, rounded once. Instead of `at` a layer that does nothing once a network is trained says
// `inference_no_op = true`.
//
// A form may take up layers behind it: `fuse<Spec, Place>()` gives std::type_identity of the form that has
// taken up one more, or not_fused. So that others can take it up, a layer says what it does in terms that
// any form may understand:
//   rectifies = true      max(x, 0)
//   channels<Place>       x · factor(channel) + offset: a batch norm; constructible from a parameter_source
//   maximum<Place>        the sliding_window whose largest value it takes
// Where maps hold something else than floats, a layer may say `output_fused<Lowered>`: a form and what the
// layer makes of its outputs, which are floats. A form on which the sum of a residual block can be left says
// `adding<bool Rectified>`: the form that adds to what lies in the output already, with a ReLU behind the sum
// or not. One that can write among the channels of a wider map says `fits_slice<MapStride, MapOffset>`, and
// `slice<MapStride, MapOffset>` is the form that does. One that can write the outputs of a network in a
// format whose maps hold something else says `as_output`: the form at Place::as_output.

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Spec>
struct lowering;

/// Where the parameters of a list of layers are.
struct parameter_source {
    const float* values;
    const float* statistics;
    double epsilon;

    /// Those of a list or a layer inside.
    [[nodiscard]] parameter_source behind(std::size_t parameters, std::size_t statistics_before) const {
        return {values + parameters, statistics + statistics_before, epsilon};
    }
};

/// A layer where it stands: layer `Index` of a list that is bound to its input, deployed in a number format.
/// Its input has `InputStride` elements from one pixel to the next.
template <class Format, class Layers, std::size_t Index, std::size_t InputStride>
struct layer_place {
    using format = Format;
    using layer = typename Layers::template at<Index>;
    static constexpr std::size_t input_stride = InputStride;
    /// The same layer where it writes the outputs of the network.
    using as_output = layer_place<typename Format::output_format, Layers, Index, InputStride>;

    /// The layer's own parameters, of those of the list.
    [[nodiscard]] static parameter_source parameters(const parameter_source& list) {
        return list.behind(Layers::template parameter_offset<Index>,
                           Layers::template statistic_offset<Index>);
    }
};

/// A step that needs no parameters.
template <class Step>
struct lowered_to {
    using step = Step;
    static void fold(const parameter_source&, float*) {}
};

/// What `fuse` gives for a layer that must have a form of its own.
struct not_fused {};

template <class Spec>
concept inference_no_op = requires {
    requires lowering<Spec>::inference_no_op;
};
template <class Spec>
concept rectifies = requires {
    requires lowering<Spec>::rectifies;
};
template <class Spec, class Place>
using channel_constants = typename lowering<Spec>::template channels<Place>;
template <class Spec, class Place>
concept scales_channels = requires {
    sizeof(channel_constants<Spec, Place>);
};
template <class Spec, class Place>
concept takes_maximum = requires {
    { lowering<Spec>::template maximum<Place> } -> std::convertible_to<sliding_window>;
};

template <class Lowered, class Spec, class Place>
concept fuses_output = Place::format::has_output_format && requires {
    sizeof(typename lowering<Spec>::template output_fused<Lowered>);
};

/// Whether a form takes up a layer behind it.
template <class Lowered, class Spec, class Place>
concept fuses = requires {
    Lowered::template fuse<Spec, Place>();
}
&&!std::is_same_v<decltype(Lowered::template fuse<Spec, Place>()), not_fused>;

/// A layer that can be deployed.
template <class Spec>
concept has_lowering = inference_no_op<Spec> || requires {
    sizeof(lowering<Spec>);
};

} // namespace TACTNET_ARCH
} // namespace tactnet
