#pragma once

#include <tactnet/deployment/plan.hpp>
#include <tactnet/layers/composition/sequence.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A list inside a list.
template <class Place, class Specification, bool Leaves = false>
struct list_form {
    using plan = planned<typename Place::format, Specification, typename Place::layer, Place::input_stride>;
    using list = typename plan::template ending_in<Leaves>;
    using step = typename list::step;
    using leaving = list_form<Place, Specification, true>;

    static void fold(const parameter_source& outer, float* to) { list::fold(Place::parameters(outer), to); }
};

template <class... Specs>
struct deployed_form<sequence<Specs...>> {
    static constexpr bool passes_on = (tactnet::passes_on<Specs> && ...);
    template <class Place>
    using at = list_form<Place, sequence<Specs...>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
