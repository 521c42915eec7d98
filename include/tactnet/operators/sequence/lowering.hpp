#pragma once

#include <tactnet/detail/indexed_leaves.hpp>
#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/frames.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/operators/sequence/named.hpp>
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
        static_assert(
            requires { typename Last::as_output; }, "deploy: in this number format a network must end in a "
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

    template <template <class> class Change, std::size_t... I>
    static auto changed(std::index_sequence<I...>) -> lowered_chain<
        typename std::conditional_t<I + 1 == size, Change<Lowered>, std::type_identity<Lowered>>::type...>;
    /// All layers, the last one changed.
    template <template <class> class Change>
    using change_last = decltype(changed<Change>(std::make_index_sequence<size>{}));
};

} // namespace detail

/// Lowers a list in a number format. Its input has `Stride` elements from one pixel to the next.
template <class Format, class Specification, class Layers, std::size_t Stride>
struct lowered_sequence;

template <class Format, class... Specs, class Layers, std::size_t Stride>
struct lowered_sequence<Format, sequence<Specs...>, Layers, Stride> {
private:
    static constexpr std::size_t layers = sizeof...(Specs);
    template <std::size_t I>
    using spec = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<Specs>...>>()))::type;
    static constexpr bool check_frames() {
        static_assert((!layer_of_sequences<Specs> && ...),
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
                              I, InputStride>;

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

    template <std::size_t I, std::size_t InputStride, class... Lowered>
    static constexpr auto lower_from() {
        if constexpr (I >= layers) {
            return detail::lowered_layers<Lowered...>{};
        } else {
            static_assert(has_lowering<spec<I>> || layer_of_sequences<spec<I>>,
                          "deploy: a layer of this kind has no lowering; has_lowering shows it");
            if constexpr (inference_no_op<spec<I>> || !has_lowering<spec<I>>) {
                return lower_from<I + 1, InputStride, Lowered...>();
            } else {
                using alone = typename lowering<spec<I>>::template at<place<I, InputStride>>;
                using whole = decltype(fuse_from<alone, I + 1>());
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
    using ending = typename lowered::template change_last<detail::output_of<IsOutput>::template change>;
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
                                           Place::input_stride>::template ending<IsOutput>;
    using step = typename list::step;
    using as_output = lowered_list<Place, Specification, true>;

    static void fold(const parameter_source& outer, float* to) { list::fold(Place::parameters(outer), to); }
};

template <class... Specs>
struct lowering<sequence<Specs...>> {
    static constexpr bool inference_no_op = (tactnet::inference_no_op<Specs> && ...);
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
