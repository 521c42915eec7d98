#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

template <std::size_t I, class T>
struct leaf {
    T value{};
};

/// One value of each type, found by index through a base class: compiles in time linear in the list, unlike
/// std::tuple's recursion.
template <class Indices, class... Ts>
struct indexed_leaves_of;
template <std::size_t... I, class... Ts>
struct indexed_leaves_of<std::index_sequence<I...>, Ts...> : leaf<I, Ts>... {};

template <class... Ts>
struct indexed_leaves : indexed_leaves_of<std::index_sequence_for<Ts...>, Ts...> {};

template <std::size_t I, class T>
[[nodiscard]] constexpr T& get(leaf<I, T>& l) {
    return l.value;
}
template <std::size_t I, class T>
[[nodiscard]] constexpr const T& get(const leaf<I, T>& l) {
    return l.value;
}
template <std::size_t I, class T>
T type_at(const leaf<I, T>&);

}}} // namespace tactnet::detail
