#pragma once

#include <tactnet/operators/concatenation/layer.hpp>
#include <tactnet/operators/concatenation/step.hpp>
#include <tactnet/operators/sequence/lowering.hpp>

#include <cstddef>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

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

} // namespace detail

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
