#pragma once

#include <tactnet/deployment/lowering/sequence.hpp>
#include <tactnet/deployment/steps/branches.hpp>
#include <tactnet/deployment/steps/convolution.hpp>
#include <tactnet/deployment/steps/gate.hpp>
#include <tactnet/layers/composition/concatenation.hpp>
#include <tactnet/layers/composition/gate.hpp>
#include <tactnet/layers/composition/residual.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// A branch by itself: no step where the branch is empty or does nothing in inference.
template <class Sequence>
using lowered_alone = std::conditional_t<Sequence::size == 0, lowered_to<no_step>, typename Sequence::type>;

/// A branch of a concatenation: it writes its slice of a map of `Stride` elements a pixel if its last layer
/// can.
template <class Sequence, std::size_t Stride, std::size_t Offset>
struct lowered_branch {
    using type = lowered_alone<Sequence>;
};
template <class Sequence, std::size_t Stride, std::size_t Offset>
    requires(Sequence::template can_write_slice<Stride, Offset>)
struct lowered_branch<Sequence, Stride, Offset> {
    using type = typename Sequence::template slice<Stride, Offset>;
};

/// Adds a map to what the output holds: a depthwise convolution by 1.
template <class Format, shape Map, std::size_t Stride, const kernels::fused_activation* Activation>
struct lowered_sum {
    static constexpr kernels::frame_convolution kernel{.window =
                                                           sliding_window::over(Map, 1, 1, padding::valid),
                                                       .filters = Map.channels,
                                                       .input_stride = Stride,
                                                       .activation = Activation,
                                                       .accumulates = true,
                                                       .groups = Map.channels};
    using step = convolution_step<Format, kernel>;

    static void fold(const parameter_source&, float* to) {
        std::fill_n(std::fill_n(to, Map.channels, 1.0F), Map.channels, 0.0F);
    }
};

/// The main branch of a residual block: its last step adds the skip, or a step after it does.
template <class Format, class Main, shape Output, const kernels::fused_activation* Activation>
auto adding_main() {
    static_assert(Main::size > 0,
                  "deploy: the main branch of a residual block must do something in inference");
    if constexpr (Main::size == 0)
        return std::type_identity<
            lowered_sum<typename Format::hidden_format, Output, Output.channels, Activation>>{};
    else if constexpr (Main::can_add)
        return std::type_identity<typename Main::template adding<Activation>>{};
    else
        return std::type_identity<
            lowered_chain<typename Main::type, lowered_sum<typename Format::hidden_format, Output,
                                                           Main::type::step::output_stride, Activation>>>{};
}

} // namespace detail

/// Both branches of a residual block, with the activation function after the sum.
template <class Place, class Main, class Skip,
          const kernels::fused_activation* Activation = &kernels::no_activation>
struct lowered_residual {
    using layer = typename Place::layer;
    using lowered_main = lowered_sequence<typename Place::format, as_sequence<Main>, typename layer::main,
                                          Place::input_stride>;
    using main = typename decltype(detail::adding_main<typename Place::format, lowered_main, layer::output,
                                                       Activation>())::type;
    using skip = detail::lowered_alone<lowered_sequence<typename Place::format, as_sequence<Skip>,
                                                        typename layer::skip, Place::input_stride>>;
    static_assert(
        !std::is_same_v<typename skip::step, no_step> ||
            std::is_same_v<typename Place::format, typename Place::format::hidden_format>,
        "deploy: in this number format a network cannot begin with a residual block that passes its "
        "input on: the frame comes in as other numbers than maps hold");
    using step = residual_step<typename main::step, typename skip::step, Place::input_stride>;

    static void fold(const parameter_source& list, float* to) {
        const parameter_source here = Place::parameters(list);
        main::fold(here, to);
        skip::fold(here.at(layer::main::parameters, layer::main::statistics),
                   to + main::step::folded_elements);
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        if constexpr (!Activation->exists && activates<Spec, typename Place::format, layer::output.channels>)
            return std::type_identity<lowered_residual<Place, Main, Skip, lowering<Spec>::activation>>{};
        else
            return not_fused{};
    }
};

template <class Main, class Skip>
struct lowering<residual<Main, Skip>> {
    template <class Place>
    using at = lowered_residual<Place, Main, Skip>;
};

/// The branch of a gate, and the product.
template <class Place, class... Branch>
struct lowered_gate {
    using layer = typename Place::layer;
    using branch = detail::lowered_alone<lowered_sequence<typename Place::format, sequence<Branch...>,
                                                          typename layer::branch, Place::input_stride>>;
    using step = gate_step<typename branch::step,
                           product_step<typename Place::format, layer::output, Place::input_stride>>;

    static void fold(const parameter_source& list, float* to) { branch::fold(Place::parameters(list), to); }
};

template <class... Branch>
struct lowering<gate<Branch...>> {
    template <class Place>
    using at = lowered_gate<Place, Branch...>;
};

/// Branches whose channels lie side by side in one map.
template <class Place, class Indices, class... Branches>
struct lowered_concatenation;

template <class Place, std::size_t... I, class... Branches>
struct lowered_concatenation<Place, std::index_sequence<I...>, Branches...> {
    using layer = typename Place::layer;
    // The same for all instruction sets, so that one exported header serves them all.
    static constexpr std::size_t stride = pad_to_cache_line(layer::output.channels);
    template <std::size_t At, class Branch>
    using branch = typename detail::lowered_branch<
        lowered_sequence<typename Place::format, as_sequence<Branch>, typename layer::template at<At>,
                         Place::input_stride>,
        stride, layer::offsets[At].channels>::type;
    using step =
        concatenation_step<typename Place::format, layer::input, Place::input_stride, stride,
                           branch_step<typename branch<I, Branches>::step, layer::offsets[I].channels>...>;

    static void fold(const parameter_source& list, float* to) {
        const parameter_source here = Place::parameters(list);
        ((branch<I, Branches>::fold(here.at(layer::offsets[I].parameters, layer::offsets[I].statistics), to),
          to += branch<I, Branches>::step::folded_elements),
         ...);
    }
};

template <class... Branches>
struct lowering<concatenation<Branches...>> {
    template <class Place>
    using at = lowered_concatenation<Place, std::index_sequence_for<Branches...>, Branches...>;
};

}} // namespace tactnet
