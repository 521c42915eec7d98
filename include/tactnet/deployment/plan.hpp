#pragma once

#include <tactnet/deployment/forms/form.hpp>
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

/// Forms one after the other, as one form.
template <class... Forms>
struct form_chain {
    using step = step_chain<typename Forms::step...>;

    static void fold(const parameter_source& list, float* to) {
        ((Forms::fold(list, to), to += Forms::step::folded), ...);
    }
};

namespace detail {

template <class Form, std::size_t Stride, std::size_t Offset>
concept goes_among = requires {
    requires Form::template fits_among<Stride, Offset>;
};

template <class... Forms>
struct form_list {
    static constexpr std::size_t size = sizeof...(Forms);
    using form = form_chain<Forms...>;
    /// Of the last.
    static constexpr bool can_add = (
        false, ..., requires { typename Forms::template adding<false>; });
    template <std::size_t Stride, std::size_t Offset>
    static constexpr bool can_go_among = (false, ..., goes_among<Forms, Stride, Offset>);
};
template <>
struct form_list<> {
    static constexpr std::size_t size = 0;
    using form = void;
    static constexpr bool can_add = false;
    template <std::size_t, std::size_t>
    static constexpr bool can_go_among = false;
};

/// The form that writes the outputs of the network.
template <class Form>
struct leaving_form {
    static_assert(
        requires { typename Form::leaving; }, "deploy: in this number format a network must end in a "
                                              "convolution, a dense layer or an average pool");
    using type = typename Form::leaving;
};

/// Forms whose last one writes among the channels of a wider map. First those that are done.
template <std::size_t Stride, std::size_t Offset, class Done, class Rest>
struct ending_among;
template <std::size_t Stride, std::size_t Offset, class... Done, class Last>
struct ending_among<Stride, Offset, form_list<Done...>, form_list<Last>> {
    using form = form_chain<Done..., typename Last::template among<Stride, Offset>>;
};
template <std::size_t Stride, std::size_t Offset, class... Done, class Form, class Next, class... Rest>
struct ending_among<Stride, Offset, form_list<Done...>, form_list<Form, Next, Rest...>>
    : ending_among<Stride, Offset, form_list<Done..., Form>, form_list<Next, Rest...>> {};

} // namespace detail

/// Plans a list in a number format. The input has `Stride` elements from one pixel to the next.
template <class Format, class Specification, class Layers, std::size_t Stride>
struct planned;

template <class Format, class... Specs, class Layers, std::size_t Stride>
struct planned<Format, sequence<Specs...>, Layers, Stride> {
private:
    static constexpr std::size_t layers = sizeof...(Specs);
    template <std::size_t I>
    using spec = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<Specs>...>>()))::type;
    /// The first layer that does something reads what the list is given, others what a layer has written.
    static constexpr std::size_t first = [] {
        constexpr std::array<bool, layers> nothing{passes_on<Specs>...};
        return static_cast<std::size_t>(std::find(nothing.begin(), nothing.end(), false) - nothing.begin());
    }();
    template <std::size_t I, std::size_t InputStride>
    using place =
        layer_place<std::conditional_t<I == first, Format, typename Format::inner>, Layers, I, InputStride>;

    /// A form and the first layer that it has not taken up.
    template <class Form, std::size_t Next>
    struct extended {
        using form = Form;
        static constexpr std::size_t next = Next;
    };
    template <class Form, std::size_t I>
    static constexpr auto extend() {
        if constexpr (I >= layers) {
            return extended<Form, I>{};
        } else if constexpr (passes_on<spec<I>>) {
            return extend<Form, I + 1>();
        } else {
            using behind = place<I, Form::step::output_stride>;
            if constexpr (absorbs<Form, spec<I>, behind>)
                return extend<typename decltype(Form::template absorb<spec<I>, behind>())::type, I + 1>();
            else if constexpr (finishes<Form, spec<I>, behind>)
                return extend<typename deployed_form<spec<I>>::template finishing<Form>, I + 1>();
            else
                return extended<Form, I>{};
        }
    }

    /// What the last form does besides.
    enum class ending { plain, adds, adds_and_rectifies, leaves };
    template <ending End, std::size_t I, std::size_t InputStride, class... Forms>
    static constexpr auto build() {
        if constexpr (I >= layers) {
            return detail::form_list<Forms...>{};
        } else {
            static_assert(has_deployed_form<spec<I>>,
                          "deploy: a layer of this kind has no deployed form; has_deployed_form shows it");
            if constexpr (passes_on<spec<I>> || !has_deployed_form<spec<I>>) {
                return build<End, I + 1, InputStride, Forms...>();
            } else {
                using alone = typename deployed_form<spec<I>>::template at<place<I, InputStride>>;
                using whole = decltype(extend<alone, I + 1>());
                using last = typename whole::form;
                if constexpr (whole::next < layers || End == ending::plain)
                    return build<End, whole::next, last::step::output_stride, Forms..., last>();
                else if constexpr (End == ending::leaves)
                    return detail::form_list<Forms..., typename detail::leaving_form<last>::type>{};
                else
                    return detail::form_list<
                        Forms..., typename last::template adding<End == ending::adds_and_rectifies>>{};
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
    /// Forms that the list consists of; none, if it does nothing once trained.
    static constexpr std::size_t size = forms::size;
    using form = typename forms::form;
    /// The same; with `Leaves` its last form writes the outputs of the network.
    template <bool Leaves>
    using ending_in = typename ended<Leaves>::form;
    /// Whether its last form can leave a sum in the output: for main branches of residual blocks.
    static constexpr bool can_add = forms::can_add;
    template <bool Rectified>
    using adding = typename summed<Rectified>::form;
    /// Whether its last form can write its channels from `Offset` on of a map with `MapStride` elements a
    /// pixel: for branches of a concatenation.
    template <std::size_t MapStride, std::size_t Offset>
    static constexpr bool can_go_among = forms::template can_go_among<MapStride, Offset>;
    template <std::size_t MapStride, std::size_t Offset>
    using among = typename detail::ending_among<MapStride, Offset, detail::form_list<>, forms>::form;
};

/// The steps of a network whose input lies pixel by pixel without gaps, and how its parameters fold into
/// them. The forms of its layers must have been included (deployment/forms.hpp).
template <class Network, class Format = single_precision>
    requires(!passes_on<typename Network::specification>) // or there is nothing to deploy
using deployment_plan =
    typename planned<typename Format::entering, typename Network::specification, typename Network::layers,
                     Network::input_shape.channels>::template ending_in<Format::leaves_apart>;

} // namespace TACTNET_ARCH
} // namespace tactnet
