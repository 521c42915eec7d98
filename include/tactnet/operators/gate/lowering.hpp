#pragma once

#include <tactnet/operators/gate/layer.hpp>
#include <tactnet/operators/gate/step.hpp>
#include <tactnet/operators/sequence/lowering.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

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

}} // namespace tactnet
