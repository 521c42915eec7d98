#pragma once

#include <tactnet/detail/config.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// The middle of points of `Values` numbers that lie far from zero against their extent; none if they lie
/// near. A search by ‖c‖² − 2 c·x swallows distances of far points in its squares: without their middle it
/// does not.
template <std::size_t Values>
[[nodiscard]] std::vector<double> far_origin(std::span<const float> points) {
    constexpr double far = 32; // deviations; nearer, 1/1000 of the squares remains
    const double count = static_cast<double>(points.size() / Values);
    std::array<double, Values> middle{};
    double extent = 0, offset = 0;
    for (std::size_t e = 0; e < points.size(); ++e)
        middle[e % Values] += static_cast<double>(points[e]) / count;
    for (std::size_t e = 0; e < points.size(); ++e) {
        const double d = static_cast<double>(points[e]) - middle[e % Values];
        extent += d * d / count;
    }
    for (const double m : middle)
        offset += m * m;
    if (offset > far * far * extent)
        return {middle.begin(), middle.end()};
    return {};
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
