#pragma once

#include <tactnet/deployment/forms/sequence.hpp>
#include <tactnet/deployment/plan.hpp>
#include <tactnet/deployment/steps/residual.hpp>
#include <tactnet/layers/composition/residual.hpp>

#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// The skip of a block that has none, or one that does nothing once trained.
struct no_skip_form {
    using step = no_step;
    static void fold(const parameter_source&, float*) {}
};

template <class Planned>
struct skip_form {
    using type = typename Planned::form;
};
template <class Planned>
    requires(Planned::size == 0)
struct skip_form<Planned> {
    using type = no_skip_form;
};

} // namespace detail

/// Both branches of a residual block, with the ReLU behind the sum.
template <class Place, class Main, class Skip, bool Rectified = false>
struct residual_form {
    using layer = typename Place::layer;
    using planned_main =
        planned<typename Place::format, as_sequence<Main>, typename layer::main, Place::input_stride>;
    static_assert(planned_main::can_add,
                  "deploy: the main branch of a residual block must end in a convolution, with or without "
                  "batch norm");
    using main = typename planned_main::template adding<Rectified>;
    using skip = typename detail::skip_form<
        planned<typename Place::format, as_sequence<Skip>, typename layer::skip, Place::input_stride>>::type;
    static_assert(
        !std::is_same_v<typename skip::step, no_step> ||
            std::is_same_v<typename Place::format, typename Place::format::inner>,
        "deploy: in this number format a network cannot begin with a residual block that passes its "
        "input on: the frame comes in as other numbers than maps hold");
    using step = residual_step<typename main::step, typename skip::step, Place::input_stride>;

    static void fold(const parameter_source& list, float* to) {
        const parameter_source here = Place::parameters(list);
        main::fold(here, to);
        skip::fold(here.behind(layer::main::parameters, layer::main::statistics), to + main::step::folded);
    }
    template <class Spec, class>
    static constexpr auto absorb() {
        if constexpr (rectifies<Spec>)
            return std::type_identity<residual_form<Place, Main, Skip, true>>{};
        else
            return not_absorbed{};
    }
};

template <class Main, class Skip>
struct deployed_form<residual<Main, Skip>> {
    template <class Place>
    using at = residual_form<Place, Main, Skip>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
