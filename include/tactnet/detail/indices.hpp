#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <type_traits>
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

// Loops over registers must be unrolled, or arrays of registers are kept in memory. If the body is the same
// for each index, use a plain loop with constant bounds after `#pragma GCC unroll 64`: the compiler unrolls
// it late, in a third of the compile time of a lambda per index, to the same machine code from -O2 on.
// `unroll` is for indices that must be constants: types, template arguments, `if constexpr`. The bound of a
// loop after the pragma must be a variable, not a call, or GCC 12 ignores the pragma; more than 64 steps stay
// a loop, correct but slow.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A number as a type, so that a lambda's argument is a constant.
template <std::size_t N>
using constant = std::integral_constant<std::size_t, N>;

/// Calls body(constant<0>{}), …, body(constant<Count - 1>{}), unrolled.
template <std::size_t Count, class Body>
[[gnu::always_inline]] inline constexpr void unroll(Body&& body) {
    [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
        (body(constant<I>{}), ...);
    }
    (std::make_index_sequence<Count>{});
}

/// Splits `Total` into blocks of `Block` and one smaller rest. Calls body(constant<size>{}, first) for each;
/// `first` is no constant.
template <std::size_t Total, std::size_t Block, class Body>
[[gnu::always_inline]] inline constexpr void blocked(Body&& body) {
    for (std::size_t first = 0; first + Block <= Total; first += Block)
        body(constant<Block>{}, first);
    if constexpr (Total % Block != 0)
        body(constant<Total % Block>{}, Total / Block * Block);
}

}}} // namespace tactnet::kernels
