#pragma once

#include <tactnet/operators/convolution/step.hpp>
#include <tactnet/operators/residual/layer.hpp>
#include <tactnet/operators/residual/step.hpp>
#include <tactnet/operators/sequence/lowering.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

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

/// The main branch of a residual block: its last step adds the skip, or a step after it does. In a stream
/// that is always a step, since both branches are rounded before the sum in a batch.
template <class Place, class Main, shape Output, const kernels::fused_activation* Activation>
auto adding_main() {
    using hidden = typename Place::format::hidden_format;
    static_assert(Main::size > 0,
                  "deploy: the main branch of a residual block must do something in inference");
    if constexpr (Main::size == 0)
        return std::type_identity<lowered_sum<hidden, Output, Output.channels, Activation>>{};
    else if constexpr (Place::in_stream)
        return std::type_identity<typename Main::template with<sum_step>>{};
    else if constexpr (Main::can_add)
        return std::type_identity<typename Main::template adding<Activation>>{};
    else
        return std::type_identity<lowered_chain<
            typename Main::type, lowered_sum<hidden, Output, Main::type::step::output_stride, Activation>>>{};
}

/// Rejects a skip that passes on a frame which has a format of its own.
template <bool PassesFrameOn>
[[nodiscard]] constexpr std::size_t stride_of_skip(std::size_t stride) {
    static_assert(
        !PassesFrameOn,
        "deploy: in this number format a network cannot begin with a residual block that passes its "
        "input on: the frame comes in as other numbers than maps hold");
    return stride;
}

} // namespace detail

/// Both branches of a residual block, with the activation function after the sum.
template <class Place, class Main, class Skip,
          const kernels::fused_activation* Activation = &kernels::no_activation>
struct lowered_residual {
    using layer = typename Place::layer;
    using lowered_main = lowered_sequence<typename Place::format, as_sequence<Main>, typename layer::main,
                                          Place::input_stride, Place::frames>;
    using main =
        typename decltype(detail::adding_main<Place, lowered_main, Place::output, Activation>())::type;
    using skip =
        detail::lowered_alone<lowered_sequence<typename Place::format, as_sequence<Skip>,
                                               typename layer::skip, Place::input_stride, Place::frames>>;
    static constexpr bool passes_frame_on =
        Place::reads_frame && std::is_same_v<typename skip::step, no_step>;
    using step = residual_step<typename main::step, typename skip::step,
                               detail::stride_of_skip<passes_frame_on>(Place::input_stride)>;

    static void fold(const parameter_source& list, float* to) {
        const parameter_source here = Place::parameters(list);
        main::fold(here, to);
        skip::fold(here.at(layer::main::parameters, layer::main::statistics),
                   to + main::step::folded_elements);
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        if constexpr (!Place::in_stream && !Activation->exists &&
                      activates<Spec, typename Place::format, layer::output.channels>)
            return std::type_identity<lowered_residual<Place, Main, Skip, lowering<Spec>::activation>>{};
        else
            return not_fused{};
    }
};

template <class Main, class Skip>
struct lowering<residual<Main, Skip>> {
    template <class Place>
    static constexpr bool in_stream = !Place::reads_frame;
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
        requires(!Place::reads_frame) // whatever the branch begins with, the product reads the input too
    using at = lowered_gate<Place, Branch...>;
};

}} // namespace tactnet
