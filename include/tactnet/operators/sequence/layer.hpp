#pragma once

#include <tactnet/operators/sequence/layer_list.hpp>

#include <cstddef>
#include <string_view>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Layers one after the other, as one layer. An empty sequence is the identity.
template <class... Specs>
struct sequence {
    static constexpr std::string_view name = "";
    static constexpr bool numbered = true;
    static constexpr std::size_t size = sizeof...(Specs);

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_of_list(input, detail::costs_of_each<detail::checked<Specs>...>(input));
    }

    template <class T, shape Input>
    using layer = layer_list<T, Input, Specs...>;
};

namespace detail {

template <class Spec>
struct as_sequence {
    using type = sequence<Spec>;
};
template <class... Specs>
struct as_sequence<sequence<Specs...>> {
    using type = sequence<Specs...>;
};

} // namespace detail

/// A list of layers unchanged, and a single layer as a list of one.
template <class Spec>
using as_sequence = typename detail::as_sequence<Spec>::type;

}} // namespace tactnet
