#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/operators/sequence/step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

// Lowers a list of layers to steps, when compiling: each layer is lowered in turn, and the layers after it
// that it can fuse become part of its step, one pass over memory.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Lowered layers, one after the other.
template <class... Lowered>
struct lowered_chain {
    using step = step_chain<typename Lowered::step...>;

    static void fold(const parameter_source& list, float* to) {
        ((Lowered::fold(list, to), to += Lowered::step::folded_elements), ...);
    }
};

namespace detail {

template <class Lowered, std::size_t Stride, std::size_t Offset>
concept writes_into_slice = requires { requires Lowered::template fits_slice<Stride, Offset>; };

template <class Lowered>
concept has_as_output = requires { typename Lowered::as_output; };

// Changes of the last layer of a list.
template <bool IsOutput>
struct output_of {
    template <class Last>
    struct change {
        using type = Last;
    };
};
template <>
struct output_of<true> {
    template <class Last>
    struct change {
        static_assert(has_as_output<Last>, "deploy: in this number format a network must end in a "
                                           "convolution, a dense layer or an average pool");
        using type = typename Last::as_output;
    };
};
template <const kernels::fused_activation* Activation>
struct adding_of {
    template <class Last>
    struct change {
        using type = typename Last::template adding<Activation>;
    };
};
template <std::size_t Stride, std::size_t Offset>
struct slice_of {
    template <class Last>
    struct change {
        using type = typename Last::template slice<Stride, Offset>;
    };
};

/// Lowered layers and a step after them, a template on the map that they write.
template <template <class, shape, std::size_t> class Step, class Format, class... Lowered>
struct appended {
    using before = typename lowered_chain<Lowered...>::step;
    using type = lowered_chain<Lowered..., lowered_to<Step<Format, before::output, before::output_stride>>>;
};

/// The lowered layers of a list.
template <class... Lowered>
struct lowered_layers {
    static constexpr std::size_t size = sizeof...(Lowered);
    using type = std::conditional_t<size == 0, void, lowered_chain<Lowered...>>;
    // About the last layer; false for an empty list.
    static constexpr bool can_add = (
        false, ..., requires { typename Lowered::template adding<nullptr>; });
    template <std::size_t Stride, std::size_t Offset>
    static constexpr bool can_write_slice = (false, ..., writes_into_slice<Lowered, Stride, Offset>);
    static constexpr bool can_end = (false, ..., has_as_output<Lowered>);

    template <template <class> class Change, std::size_t... I>
    static auto changed(std::index_sequence<I...>) -> lowered_chain<
        typename std::conditional_t<I + 1 == size, Change<Lowered>, std::type_identity<Lowered>>::type...>;
    /// All layers, the last one changed.
    template <template <class> class Change>
    using change_last = decltype(changed<Change>(std::make_index_sequence<size>{}));
    template <template <class, shape, std::size_t> class Step, class Format>
    using with = typename appended<Step, Format, Lowered...>::type;
};

/// Rejects a layer that `deploy_stream` cannot run frame by frame.
template <class Spec, class Place>
constexpr bool check_in_stream() {
    if constexpr (std::is_same_v<typename Place::format::output_format, single_precision>)
        static_assert(
            runs_in_streams<Spec, Place>,
            "deploy_stream: this layer does not run frame by frame; runs_in_streams shows it and its "
            "input. Dense layers come after last_frame; for each frame, use causal_conv1d<outputs, 1>");
    else
        static_assert(
            runs_in_streams<Spec, Place>,
            "deploy_stream: in 8 bits this layer does not run frame by frame here; runs_in_streams "
            "shows it, its input and the format of numbers. The first layer reads words of 16 bits: it "
            "must be gru, lstm, causal_conv1d or dense. Dense layers come after last_frame");
    return runs_in_streams<Spec, Place>;
}
/// The list that writes the outputs of the network if `IsOutput`: by its last layer or, in a stream, by a
/// step after it.
template <class Layers, class Format, bool IsOutput, bool InStream>
struct ending_of {
    using type = typename Layers::template change_last<output_of<IsOutput>::template change>;
};
template <class Layers, class Format>
    requires(!Layers::can_end)
struct ending_of<Layers, Format, true, true> {
    using type = typename Layers::template with<float_output_step, Format>;
};

} // namespace detail

/// Lowers a list in a number format. Its input has `Stride` elements from one pixel to the next. `Frames` as
/// in layer_place.
template <class Format, class Specification, class Layers, std::size_t Stride, std::size_t Frames = 0>
struct lowered_sequence;

template <class Format, class... Specs, class Layers, std::size_t Stride, std::size_t Frames>
struct lowered_sequence<Format, sequence<Specs...>, Layers, Stride, Frames> {
private:
    static constexpr std::size_t layers = sizeof...(Specs);
    template <std::size_t I>
    using spec = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<Specs>...>>()))::type;
    static constexpr bool check_frames() {
        static_assert(Frames > 0 || (!layer_of_sequences<Specs> && ...),
                      "deploy: a network of sequences runs frame by frame: use deploy_stream");
        return true;
    }
    static_assert(check_frames());
    /// The first layer that does something reads the input of the list, the others read maps.
    static constexpr std::size_t first = [] {
        constexpr std::array<bool, layers> nothing{inference_no_op<Specs>...};
        return static_cast<std::size_t>(std::find(nothing.begin(), nothing.end(), false) - nothing.begin());
    }();
    template <std::size_t I, std::size_t InputStride>
    using place = layer_place<std::conditional_t<I == first, Format, typename Format::hidden_format>, Layers,
                              I, InputStride, Frames>;

    /// A lowered layer with all that it fuses, and the first layer after these.
    template <class Lowered, std::size_t Next>
    struct fusion {
        using type = Lowered;
        static constexpr std::size_t next = Next;
    };
    template <class Lowered, std::size_t I>
    static constexpr auto fuse_from() {
        if constexpr (I >= layers) {
            return fusion<Lowered, I>{};
        } else if constexpr (inference_no_op<spec<I>>) {
            return fuse_from<Lowered, I + 1>();
        } else {
            using next = place<I, Lowered::step::output_stride>;
            if constexpr (fuses<Lowered, spec<I>, next>)
                return fuse_from<typename decltype(Lowered::template fuse<spec<I>, next>())::type, I + 1>();
            else if constexpr (fuses_output<Lowered, spec<I>, next>)
                return fuse_from<typename lowering<spec<I>>::template output_fused<Lowered>, I + 1>();
            else
                return fusion<Lowered, I>{};
        }
    }

    template <std::size_t I, std::size_t InputStride>
    static constexpr bool check_lowering() {
        if constexpr (Frames > 0)
            return detail::check_in_stream<spec<I>, place<I, InputStride>>();
        static_assert(Frames > 0 || has_lowering<spec<I>>,
                      "deploy: a layer of this kind has no lowering; has_lowering shows it");
        return has_lowering<spec<I>> && !layer_of_sequences<spec<I>>;
    }
    /// The place of layer I. If its step is not defined for numbers that the frame alone has, the layer goes
    /// where it reads a map, or more errors follow.
    template <std::size_t I, std::size_t InputStride>
    static constexpr auto place_of() {
        using here = place<I, InputStride>;
        if constexpr (!here::reads_frame) {
            return std::type_identity<here>{};
        } else {
            constexpr bool can = requires { sizeof(typename lowering<spec<I>>::template at<here>::step); };
            static_assert(
                can,
                "deploy: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a "
                "group, instance, layer or local response norm: a convolution, a dense layer or a batch "
                "norm must come first");
            using after = layer_place<typename Format::hidden_format, Layers, I, InputStride, Frames>;
            return std::type_identity<std::conditional_t<can, here, after>>{};
        }
    }
    template <std::size_t I, std::size_t InputStride, class... Lowered>
    static constexpr auto lower_from() {
        if constexpr (I >= layers) {
            return detail::lowered_layers<Lowered...>{};
        } else {
            if constexpr (inference_no_op<spec<I>> || !check_lowering<I, InputStride>()) {
                return lower_from<I + 1, InputStride, Lowered...>();
            } else {
                using alone = typename lowering<spec<I>>::template at<
                    typename decltype(place_of<I, InputStride>())::type>;
                using whole = decltype(fuse_from<alone, I + 1>());
                static_assert(
                    !layer_of_sequences<spec<I>> || !has_state<typename alone::step> ||
                        Layers::template at<I>::input.rows == Frames,
                    "deploy_stream: after last_frame, layers have one frame of each sequence: gru, lstm and "
                    "causal_conv1d of several taps must come before it"); // a stream has no end
                return lower_from<whole::next, whole::type::step::output_stride, Lowered...,
                                  typename whole::type>();
            }
        }
    }
    using lowered = decltype(lower_from<0, Stride>());

public:
    /// How many steps the list becomes: none, if it does nothing in inference.
    static constexpr std::size_t size = lowered::size;
    /// The lowered list; void if it does nothing in inference.
    using type = typename lowered::type;
    /// The lowered list; with `IsOutput` it writes the outputs of the network.
    template <bool IsOutput>
    using ending =
        typename detail::ending_of<lowered, typename Format::hidden_format, IsOutput, Frames != 0>::type;
    /// The list and a sum_step after it: the main branch of a residual block in a stream.
    template <template <class, shape, std::size_t> class Step>
    using with = typename lowered::template with<Step, typename Format::hidden_format>;
    /// Whether the last layer can add to what its output holds: for main branches of residual blocks.
    static constexpr bool can_add = lowered::can_add;
    template <const kernels::fused_activation* Activation>
    using adding = typename lowered::template change_last<detail::adding_of<Activation>::template change>;
    /// Whether the last layer can write its channels from `Offset` on of a map with `MapStride` elements a
    /// pixel: for branches of a concatenation.
    template <std::size_t MapStride, std::size_t Offset>
    static constexpr bool can_write_slice = lowered::template can_write_slice<MapStride, Offset>;
    template <std::size_t MapStride, std::size_t Offset>
    using slice =
        typename lowered::template change_last<detail::slice_of<MapStride, Offset>::template change>;
};

/// The steps of a network whose input lies pixel by pixel without gaps, and how its parameters fold into
/// them. Include the lowerings of its layers first (deployment/deploy.hpp does).
template <class Network, class Format = single_precision>
    requires(!inference_no_op<typename Network::specification>) // or there is nothing to deploy
using lowered_network =
    typename lowered_sequence<typename Format::input_format, typename Network::specification,
                              typename Network::layers,
                              Network::input_shape.channels>::template ending<Format::has_output_format>;

/// A list inside a list.
template <class Place, class Specification, bool IsOutput = false>
struct lowered_list {
    using list = typename lowered_sequence<typename Place::format, Specification, typename Place::layer,
                                           Place::input_stride, Place::frames>::template ending<IsOutput>;
    using step = typename list::step;
    using as_output = lowered_list<Place, Specification, true>;

    static void fold(const parameter_source& outer, float* to) { list::fold(Place::parameters(outer), to); }
};

template <class... Specs>
struct lowering<sequence<Specs...>> {
    static constexpr bool inference_no_op = (tactnet::inference_no_op<Specs> && ...);
    template <class>
    static constexpr bool in_stream = true; // each layer of the list says it for itself
    template <class Place>
    using at = lowered_list<Place, sequence<Specs...>>;
};

template <name_text Name, class Spec>
struct lowering<named<Name, Spec>> : lowering<Spec> {};

namespace detail {

/// A branch by itself: no step where the branch is empty or does nothing in inference.
template <class Sequence>
using lowered_alone = std::conditional_t<Sequence::size == 0, lowered_to<no_step>, typename Sequence::type>;

} // namespace detail

}} // namespace tactnet
