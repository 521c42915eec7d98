#pragma once

#include <tactnet/detail/indexed_leaves.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>

namespace tactnet::inline TACTNET_ARCH {

namespace detail {

/// A layer at its place in a list. Offsets count from the start of the list's arrays.
template <class Layer, std::size_t Parameters, std::size_t Statistics>
struct placed {
    using type = Layer;
    static constexpr std::size_t parameter_offset = Parameters, statistic_offset = Statistics;
};

/// Lets shapes and offsets flow through the list.
template <class T, shape Input, class Placed, class... Specs>
struct chain {
    using layers = Placed;
    static constexpr shape output = Input;
};
template <class T, shape Input, class... Placed, class Spec, class... Rest>
struct chain<T, Input, indexed_leaves<Placed...>, Spec, Rest...> {
    using here = typename Spec::template layer<T, Input>;
    static constexpr std::size_t parameters = (std::size_t{0} + ... + Placed::type::parameters);
    static constexpr std::size_t statistics = (std::size_t{0} + ... + Placed::type::statistics);
    using next =
        chain<T, here::output, indexed_leaves<Placed..., placed<here, parameters, statistics>>, Rest...>;
    using layers = typename next::layers;
    static constexpr shape output = next::output;
};

} // namespace detail

} // namespace tactnet
