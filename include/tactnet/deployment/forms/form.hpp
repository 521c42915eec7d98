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
//     struct tactnet::deployed_form<my_layer> {
//         template <class Place>
//         using at = tactnet::form_without_parameters<my_step<typename Place::format, …>>;
//     };
//
// `at` is the form of the layer at its place in a list: `step`, what it does (deployment/steps/step.hpp), and
// `fold(list, to)`, which makes the step's folded numbers from the parameters of the list, in double
// precision, rounded once. Instead of `at` a layer that does nothing once a network is trained says
// `passes_on = true`.
//
// A form may take up layers behind it: `absorb<Spec, Place>()` gives std::type_identity of the form that has
// taken up one more, or not_absorbed. So that others can take it up, a layer says what it does in terms that
// any form may understand:
//   rectifies = true      max(x, 0)
//   channels<Place>       x · factor(channel) + offset: a batch norm; constructible from a parameter_source
//   maximum<Place>        the sliding_window whose largest value it takes
// Where maps hold something else than floats, a layer may say `finishing<Form>`: a form and what the layer
// makes of its outputs, which are floats. A form on which the sum of a residual block can be left says
// `adding<bool Rectified>`: the form that adds to what lies in the output already, with a ReLU behind the sum
// or not. One that can write among the channels of a wider map says `fits_among<MapStride, MapOffset>`, and
// `among<MapStride, MapOffset>` is the form that does. One that can write the outputs of a network in a
// format whose maps hold something else says `leaving`: the form at Place::leaving.

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Spec>
struct deployed_form;

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
    using leaving = layer_place<typename Format::leaving, Layers, Index, InputStride>;

    /// The layer's own parameters, of those of the list.
    [[nodiscard]] static parameter_source parameters(const parameter_source& list) {
        return list.behind(Layers::template parameter_offset<Index>,
                           Layers::template statistic_offset<Index>);
    }
};

/// A step that needs no parameters.
template <class Step>
struct form_without_parameters {
    using step = Step;
    static void fold(const parameter_source&, float*) {}
};

/// What `absorb` gives for a layer that must have a form of its own.
struct not_absorbed {};

template <class Spec>
concept passes_on = requires {
    requires deployed_form<Spec>::passes_on;
};
template <class Spec>
concept rectifies = requires {
    requires deployed_form<Spec>::rectifies;
};
template <class Spec, class Place>
using channel_constants = typename deployed_form<Spec>::template channels<Place>;
template <class Spec, class Place>
concept scales_channels = requires {
    sizeof(channel_constants<Spec, Place>);
};
template <class Spec, class Place>
concept takes_maximum = requires {
    { deployed_form<Spec>::template maximum<Place> } -> std::convertible_to<sliding_window>;
};

template <class Form, class Spec, class Place>
concept finishes = Place::format::leaves_apart && requires {
    sizeof(typename deployed_form<Spec>::template finishing<Form>);
};

/// Whether a form takes up a layer behind it.
template <class Form, class Spec, class Place>
concept absorbs = requires {
    Form::template absorb<Spec, Place>();
}
&&!std::is_same_v<decltype(Form::template absorb<Spec, Place>()), not_absorbed>;

/// A layer that can be deployed.
template <class Spec>
concept has_deployed_form = passes_on<Spec> || requires {
    sizeof(deployed_form<Spec>);
};

} // namespace TACTNET_ARCH
} // namespace tactnet
