#pragma once

#include <tactnet/deployment/lowering/sequence.hpp>
#include <tactnet/layers/composition/sequence.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

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
