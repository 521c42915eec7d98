#pragma once

#include <tactnet/runtime/random.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose one{3};
inline constexpr random_purpose other{3};
} // namespace random_purposes

} // namespace TACTNET_ARCH
} // namespace tactnet
