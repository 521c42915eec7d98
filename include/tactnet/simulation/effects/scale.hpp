#pragma once

#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// Multiplies all values by one factor, as effects do that befall the whole film alike. A factor below zero
/// or NaN counts as zero, and none is so large that it makes NaN of zero.
template <shape Shape>
void scale(signal<Shape> values, double factor) noexcept {
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    const auto kept = static_cast<float>(factor > 0 ? std::min(factor, most) : 0.0);
    for (std::size_t i = 0; i < Shape.size(); ++i)
        values.data()[i] *= kept;
}

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
