#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/chain.hpp>
#include <tactnet/detail/indexed_leaves.hpp>
#include <tactnet/layers/composition/sequence.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

// From a list of layers to the steps of its deployed form, when compiling. The plan walks the list and asks
// each layer for its form; what one form can take up of the layers behind it becomes one step, one pass over
// memory.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Lowered one after the other, as one form.
template <class... Lowered>
struct lowered_chain {
    using step = step_chain<typename Lowered::step...>;

    static void fold(const parameter_source& list, float* to) {
        ((Lowered::fold(list, to), to += Lowered::step::folded), ...);
    }
};

namespace detail {

template <class Lowered, std::size_t Stride, std::size_t Offset>
concept writes_into_slice = requires {
    requires Lowered::template fits_slice<Stride, Offset>;
};

template <class... Lowered>
struct lowered_layers {
    static constexpr std::size_t size = sizeof...(Lowered);
    using type = lowered_chain<Lowered...>;
    /// Of the last.
    static constexpr bool can_add = (
        false, ..., requires { typename Lowered::template adding<false>; });
    template <std::size_t Stride, std::size_t Offset>
    static constexpr bool can_write_slice = (false, ..., writes_into_slice<Lowered, Stride, Offset>);
};
template <>
struct lowered_layers<> {
    static constexpr std::size_t size = 0;
    using type = void;
    static constexpr bool can_add = false;
    template <std::size_t, std::size_t>
    static constexpr bool can_write_slice = false;
};

/// The form that writes the outputs of the network.
template <class Lowered>
struct lowered_output {
    static_assert(
        requires { typename Lowered::as_output; }, "deploy: in this number format a network must end in a "
                                                   "convolution, a dense layer or an average pool");
    using type = typename Lowered::as_output;
};

/// Lowered whose last one writes among the channels of a wider map. First those that are done.
template <std::size_t Stride, std::size_t Offset, class Done, class Rest>
struct ending_in_slice;
template <std::size_t Stride, std::size_t Offset, class... Done, class Last>
struct ending_in_slice<Stride, Offset, lowered_layers<Done...>, lowered_layers<Last>> {
    using type = lowered_chain<Done..., typename Last::template slice<Stride, Offset>>;
};
template <std::size_t Stride, std::size_t Offset, class... Done, class Lowered, class Next, class... Rest>
struct ending_in_slice<Stride, Offset, lowered_layers<Done...>, lowered_layers<Lowered, Next, Rest...>>
    : ending_in_slice<Stride, Offset, lowered_layers<Done..., Lowered>, lowered_layers<Next, Rest...>> {};

} // namespace detail

/// Plans a list in a number format. The input has `Stride` elements from one pixel to the next.
template <class Format, class Specification, class Layers, std::size_t Stride>
struct lowered_sequence;

template <class Format, class... Specs, class Layers, std::size_t Stride>
struct lowered_sequence<Format, sequence<Specs...>, Layers, Stride> {
private:
    static constexpr std::size_t layers = sizeof...(Specs);
    template <std::size_t I>
    using spec = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<Specs>...>>()))::type;
    /// The first layer that does something reads what the list is given, others what a layer has written.
    static constexpr std::size_t first = [] {
        constexpr std::array<bool, layers> nothing{inference_no_op<Specs>...};
        return static_cast<std::size_t>(std::find(nothing.begin(), nothing.end(), false) - nothing.begin());
    }();
    template <std::size_t I, std::size_t InputStride>
    using place = layer_place<std::conditional_t<I == first, Format, typename Format::hidden_format>, Layers,
                              I, InputStride>;

    /// A form and the first layer that it has not taken up.
    template <class Lowered, std::size_t Next>
    struct extended {
        using type = Lowered;
        static constexpr std::size_t next = Next;
    };
    template <class Lowered, std::size_t I>
    static constexpr auto extend() {
        if constexpr (I >= layers) {
            return extended<Lowered, I>{};
        } else if constexpr (inference_no_op<spec<I>>) {
            return extend<Lowered, I + 1>();
        } else {
            using behind = place<I, Lowered::step::output_stride>;
            if constexpr (fuses<Lowered, spec<I>, behind>)
                return extend<typename decltype(Lowered::template fuse<spec<I>, behind>())::type, I + 1>();
            else if constexpr (fuses_output<Lowered, spec<I>, behind>)
                return extend<typename lowering<spec<I>>::template output_fused<Lowered>, I + 1>();
            else
                return extended<Lowered, I>{};
        }
    }

    /// What the last form does besides.
    enum class ending { plain, adds, adds_and_rectifies, leaves };
    template <ending End, std::size_t I, std::size_t InputStride, class... Lowered>
    static constexpr auto build() {
        if constexpr (I >= layers) {
            return detail::lowered_layers<Lowered...>{};
        } else {
            static_assert(has_lowering<spec<I>>,
                          "deploy: a layer of this kind has no lowering; has_lowering shows it");
            if constexpr (inference_no_op<spec<I>> || !has_lowering<spec<I>>) {
                return build<End, I + 1, InputStride, Lowered...>();
            } else {
                using alone = typename lowering<spec<I>>::template at<place<I, InputStride>>;
                using whole = decltype(extend<alone, I + 1>());
                using last = typename whole::type;
                if constexpr (whole::next < layers || End == ending::plain)
                    return build<End, whole::next, last::step::output_stride, Lowered..., last>();
                else if constexpr (End == ending::leaves)
                    return detail::lowered_layers<Lowered..., typename detail::lowered_output<last>::type>{};
                else
                    return detail::lowered_layers<
                        Lowered..., typename last::template adding<End == ending::adds_and_rectifies>>{};
            }
        }
    }
    using forms = decltype(build<ending::plain, 0, Stride>());
    // Not an alias, in which Clang 14 sees no private members.
    template <bool Leaves>
    struct ended : decltype(build < Leaves ? ending::leaves : ending::plain, 0, Stride > ()) {};
    template <bool Rectified>
    struct summed : decltype(build < Rectified ? ending::adds_and_rectifies : ending::adds, 0, Stride > ()) {
    };

public:
    /// Lowered that the list consists of; none, if it does nothing once trained.
    static constexpr std::size_t size = forms::size;
    using type = typename forms::type;
    /// The same; with `Leaves` its last form writes the outputs of the network.
    template <bool Leaves>
    using ending_in = typename ended<Leaves>::type;
    /// Whether its last form can leave a sum in the output: for main branches of residual blocks.
    static constexpr bool can_add = forms::can_add;
    template <bool Rectified>
    using adding = typename summed<Rectified>::type;
    /// Whether its last form can write its channels from `Offset` on of a map with `MapStride` elements a
    /// pixel: for branches of a concatenation.
    template <std::size_t MapStride, std::size_t Offset>
    static constexpr bool can_write_slice = forms::template can_write_slice<MapStride, Offset>;
    template <std::size_t MapStride, std::size_t Offset>
    using slice = typename detail::ending_in_slice<MapStride, Offset, detail::lowered_layers<>, forms>::type;
};

/// The steps of a network whose input lies pixel by pixel without gaps, and how its parameters fold into
/// them. The forms of its layers must have been included (deployment/lowering.hpp).
template <class Network, class Format = single_precision>
    requires(!inference_no_op<typename Network::specification>) // or there is nothing to deploy
using lowered_network =
    typename lowered_sequence<typename Format::input_format, typename Network::specification,
                              typename Network::layers,
                              Network::input_shape.channels>::template ending_in<Format::has_output_format>;

/// A list inside a list.
template <class Place, class Specification, bool Leaves = false>
struct lowered_list {
    using plan =
        lowered_sequence<typename Place::format, Specification, typename Place::layer, Place::input_stride>;
    using list = typename plan::template ending_in<Leaves>;
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

} // namespace TACTNET_ARCH
} // namespace tactnet
