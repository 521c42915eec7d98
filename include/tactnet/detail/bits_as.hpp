#pragma once

#include <tactnet/detail/config.hpp>

#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// std::bit_cast, which standard libraries for WebAssembly lack: the same built-in function.
template <class To, class From>
    requires(sizeof(To) == sizeof(From) && std::is_trivially_copyable_v<To> &&
             std::is_trivially_copyable_v<From>)
[[nodiscard]] constexpr To bits_as(const From& value) noexcept {
    return __builtin_bit_cast(To, value);
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
