#pragma once

#include <tactnet/deployment/lowering/residual.hpp>
#include <tactnet/deployment/lowering/sequence.hpp>
#include <tactnet/deployment/steps/concatenation.hpp>
#include <tactnet/layers/composition/concatenation.hpp>

#include <cstddef>
#include <type_traits>
#include <utility>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// A branch of a concatenation, at its place in a map of `Stride` elements a pixel if its last form can write
/// there.
template <class Sequence, std::size_t Stride, std::size_t Offset>
struct lowered_branch {
    using type = typename lowered_skip<Sequence>::type;
};
template <class Sequence, std::size_t Stride, std::size_t Offset>
    requires(Sequence::template can_write_slice<Stride, Offset>)
struct lowered_branch<Sequence, Stride, Offset> {
    using type = typename Sequence::template slice<Stride, Offset>;
};

} // namespace detail

/// Branches that write their channels side by side into one map.
template <class Place, class Indices, class... Branches>
struct lowered_concatenation;

template <class Place, std::size_t... I, class... Branches>
struct lowered_concatenation<Place, std::index_sequence<I...>, Branches...> {
    using layer = typename Place::layer;
    /// The same for any instruction set, so that a header written for one serves all.
    static constexpr std::size_t stride = whole_lines(layer::output.channels);
    template <std::size_t At, class Branch>
    using form_of = typename detail::lowered_branch<
        lowered_sequence<typename Place::format, as_sequence<Branch>, typename layer::template at<At>,
                         Place::input_stride>,
        stride, layer::positions[At].channels>::type;
    using step =
        concatenation_step<typename Place::format, layer::input, Place::input_stride, stride,
                           branch_step<typename form_of<I, Branches>::step, layer::positions[I].channels>...>;

    static void fold(const parameter_source& list, float* to) {
        const parameter_source here = Place::parameters(list);
        ((form_of<I, Branches>::fold(
              here.behind(layer::positions[I].parameters, layer::positions[I].statistics), to),
          to += form_of<I, Branches>::step::folded),
         ...);
    }
};

template <class... Branches>
struct lowering<concatenation<Branches...>> {
    template <class Place>
    using at = lowered_concatenation<Place, std::index_sequence_for<Branches...>, Branches...>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
