#pragma once

#include <tactnet/runtime/random.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace draw {
inline constexpr random_purpose one{3};
inline constexpr random_purpose other{3};
} // namespace draw

} // namespace TACTNET_ARCH
} // namespace tactnet
