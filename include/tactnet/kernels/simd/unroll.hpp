#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <type_traits>
#include <utility>

// Loops over registers must be written out, or what should stay in registers lies in memory. Where the body
// is the same for every number, that is a plain loop with constant bounds behind `#pragma GCC unroll 64`: the
// compiler writes it out late, which takes a third of the time that a lambda for each number takes, and gives
// the same machine code from -O2 on. `unroll` is for what needs the number as a constant: types, template
// arguments, `if constexpr`. The bound of a loop behind the pragma must be a variable, not a call, or GCC 12
// ignores the pragma; beyond 64 steps it stays a loop, right but slow.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// A number as a type, so that a lambda's argument can be a constant.
template <std::size_t N>
using constant = std::integral_constant<std::size_t, N>;

/// body(constant<0>{}), …, body(constant<Count - 1>{}), written out by the compiler.
template <std::size_t Count, class Body>
[[gnu::always_inline]] inline constexpr void unroll(Body&& body) {
    [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
        (body(constant<I>{}), ...);
    }
    (std::make_index_sequence<Count>{});
}

/// Splits `Total` into blocks of `Block` and one smaller rest: body(constant<size>{}, first), where the size
/// is a constant and the first element is not.
template <std::size_t Total, std::size_t Block, class Body>
[[gnu::always_inline]] inline constexpr void blocked(Body&& body) {
    for (std::size_t first = 0; first + Block <= Total; first += Block)
        body(constant<Block>{}, first);
    if constexpr (Total % Block != 0)
        body(constant<Total % Block>{}, Total / Block * Block);
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
