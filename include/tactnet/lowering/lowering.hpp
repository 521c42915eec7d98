#pragma once

#include <tactnet/kernels/fused_activation.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/tensor/shape.hpp>

#include <concepts>
#include <cstddef>
#include <type_traits>

// How a layer becomes a step when a network is deployed: a trait of its specification, in a file of this
// folder or in the file of your own layer:
//
//     template <>
//     struct tactnet::lowering<my_layer> {
//         template <class Place>
//         using at = tactnet::lowered_to<my_step<typename Place::format, …>>;
//     };
//
// `at` is the lowered layer at its place in a list. It has a `step` (lowering/step.hpp) and a
// function `fold(list, to)`, which computes the step's folded numbers from the parameters of the list, in
// double precision, rounded once. A layer that does nothing in inference says `inference_no_op = true`
// instead.
//
// A lowered layer may fuse the layers after it: `fuse<Spec, Place>()` returns std::type_identity of the
// lowered layer that includes the next one, or not_fused. For that, a layer describes itself in terms that
// every lowered layer may understand:
//   rectifies = true      max(x, 0), for norms
//   activation            for convolutions: tactnet::fused<Function>, a kernels::fused_activation. A ReLU
//                         has both members
//   channels<Place>       x · factor(channel) + offset: a batch norm; constructible from a parameter_source
//   maximum<Place>        the sliding_window whose maximum it takes
// A lowered layer may have further members:
//   adding<Activation>             adds its output to what the output holds, with an activation function
//                                  after the sum or nullptr: the end of a residual block's main branch
//   fits_slice<Stride, Offset>     whether it can write a slice of the channels of a wider map
//   slice<Stride, Offset>          the lowered layer that does
//   as_output                      the lowered layer that writes the outputs of the network, in formats that
//                                  write them otherwise than maps
//   in_stream<Place>               of the lowering: whether `deploy_stream` can run it frame by frame, with
//   the
//                                  bits of the layer in a batch
// In formats that write outputs otherwise a layer may have `output_fused<Lowered>`: a lowered layer, and this
// layer applied to its outputs, which are floats.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Specialised for each layer that can be deployed.
template <class Spec>
struct lowering;

/// The parameters and statistics of a list of layers.
struct parameter_source {
    const float* values;
    const float* statistics;
    double epsilon;

    /// The parameters of a list or a layer inside, after so many parameters and statistics of this list.
    [[nodiscard]] parameter_source at(std::size_t parameter_offset, std::size_t statistic_offset) const {
        return {values + parameter_offset, statistics + statistic_offset, epsilon};
    }
};

/// The place of a layer: layer `Index` of a list that is bound to its input, deployed in a number format. Its
/// input has `InputStride` elements from one pixel to the next. In a stream, which runs frame by frame,
/// `Frames` is the number of frames of the network's sequences; otherwise it is 0.
template <class Format, class Layers, std::size_t Index, std::size_t InputStride, std::size_t Frames = 0>
struct layer_place {
    using format = Format;
    using layer = typename Layers::template at<Index>;
    static constexpr std::size_t input_stride = InputStride, frames = Frames;
    static constexpr bool in_stream = Frames > 0;
    /// The map that the layer's step reads and the one that it writes.
    static constexpr shape input = in_stream ? shape{1, 1, layer::input.channels} : layer::input,
                           output = in_stream ? shape{1, 1, layer::output.channels} : layer::output;
    /// Whether the step reads the frame, in a format in which that holds other numbers than maps.
    static constexpr bool reads_frame = !std::is_same_v<Format, typename Format::hidden_format>;
    /// This layer as the last one, which writes the outputs of the network.
    using as_output = layer_place<typename Format::output_format, Layers, Index, InputStride, Frames>;

    /// The layer's own parameters.
    [[nodiscard]] static parameter_source parameters(const parameter_source& list) {
        return list.at(Layers::template parameter_offset<Index>, Layers::template statistic_offset<Index>);
    }
};

/// A layer lowered to a step without parameters.
template <class Step>
struct lowered_to {
    using step = Step;
    static void fold(const parameter_source&, float*) {}
};

/// Returned by `fuse` for a layer that is not fused.
struct not_fused {};

/// A layer that does nothing in inference.
template <class Spec>
concept inference_no_op = requires { requires lowering<Spec>::inference_no_op; };
/// A ReLU.
template <class Spec>
concept rectifies = requires { requires lowering<Spec>::rectifies; };
/// An activation function that a convolution of this number format, with so many filters, may compute in its
/// epilogue. If the function moves zero, filters must fill the vectors of every instruction set: the steps of
/// a network must not depend on it.
template <class Spec, class Format, std::size_t Filters>
concept activates = requires {
    { lowering<Spec>::activation } -> std::convertible_to<const kernels::fused_activation*>;
    requires lowering<Spec>::activation->rectifies ||
                 (Format::fuses_functions && (!lowering<Spec>::activation->moves_zero || Filters % 16 == 0));
};
/// The factor and the offset that a layer applies to each channel.
template <class Spec, class Place>
using channel_constants = typename lowering<Spec>::template channels<Place>;
template <class Spec, class Place>
concept scales_channels = requires { sizeof(channel_constants<Spec, Place>); };
template <class Spec, class Place>
concept pools_maximum = requires {
    { lowering<Spec>::template maximum<Place> } -> std::convertible_to<sliding_window>;
};

/// Whether a layer is applied to the outputs of the lowered layer before it, in its step.
template <class Lowered, class Spec, class Place>
concept fuses_output = Place::format::has_output_format &&
                       requires { sizeof(typename lowering<Spec>::template output_fused<Lowered>); };

/// Whether a lowered layer fuses the layer after it.
template <class Lowered, class Spec, class Place>
concept fuses = requires { Lowered::template fuse<Spec, Place>(); } &&
                !std::is_same_v<decltype(Lowered::template fuse<Spec, Place>()), not_fused>;

/// The result of `fuse` in a lowered layer that fuses a ReLU and nothing else: `Rectified` includes it.
template <class Spec, class Rectified>
[[nodiscard]] constexpr auto fuse_relu() {
    if constexpr (rectifies<Spec>)
        return std::type_identity<Rectified>{};
    else
        return not_fused{};
}

/// A layer that can be deployed.
template <class Spec>
concept has_lowering = inference_no_op<Spec> || requires { sizeof(lowering<Spec>); };
/// A layer that `deploy_stream` can run frame by frame at this place.
template <class Spec, class Place>
concept runs_in_streams =
    inference_no_op<Spec> || requires { requires lowering<Spec>::template in_stream<Place>; };

}} // namespace tactnet
