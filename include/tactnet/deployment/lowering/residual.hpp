#pragma once

#include <tactnet/deployment/lowering/list.hpp>
#include <tactnet/deployment/lowering/sequence.hpp>
#include <tactnet/deployment/steps/residual.hpp>
#include <tactnet/layers/composition/residual.hpp>

#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// The skip of a block that has none, or one that does nothing once trained.
struct lowered_identity {
    using step = no_step;
    static void fold(const parameter_source&, float*) {}
};

template <class Sequence>
struct lowered_skip {
    using type = typename Sequence::type;
};
template <class Sequence>
    requires(Sequence::size == 0)
struct lowered_skip<Sequence> {
    using type = lowered_identity;
};

} // namespace detail

/// Both branches of a residual block, with the ReLU behind the sum.
template <class Place, class Main, class Skip, bool Rectified = false>
struct lowered_residual {
    using layer = typename Place::layer;
    using lowered_main = lowered_sequence<typename Place::format, as_sequence<Main>, typename layer::main,
                                          Place::input_stride>;
    static_assert(lowered_main::can_add,
                  "deploy: the main branch of a residual block must end in a convolution, with or without "
                  "batch norm");
    using main = typename lowered_main::template adding<Rectified>;
    using skip =
        typename detail::lowered_skip<lowered_sequence<typename Place::format, as_sequence<Skip>,
                                                       typename layer::skip, Place::input_stride>>::type;
    static_assert(
        !std::is_same_v<typename skip::step, no_step> ||
            std::is_same_v<typename Place::format, typename Place::format::hidden_format>,
        "deploy: in this number format a network cannot begin with a residual block that passes its "
        "input on: the frame comes in as other numbers than maps hold");
    using step = residual_step<typename main::step, typename skip::step, Place::input_stride>;

    static void fold(const parameter_source& list, float* to) {
        const parameter_source here = Place::parameters(list);
        main::fold(here, to);
        skip::fold(here.behind(layer::main::parameters, layer::main::statistics), to + main::step::folded);
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        if constexpr (rectifies<Spec>)
            return std::type_identity<lowered_residual<Place, Main, Skip, true>>{};
        else
            return not_fused{};
    }
};

template <class Main, class Skip>
struct lowering<residual<Main, Skip>> {
    template <class Place>
    using at = lowered_residual<Place, Main, Skip>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
