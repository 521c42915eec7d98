#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Points of `values` numbers, one after the other: at least one, none of them cut, of numbers whose squared
/// distances stay finite in single precision. Throws std::invalid_argument that begins with the name of the
/// caller and names the first number that is NaN, infinite or larger than 10¹⁷.
inline void check_points(const char* caller, std::span<const float> points, std::size_t values) {
    const auto refuse = [&](const std::string& problem) {
        throw std::invalid_argument(std::string(caller) + ": expected " + problem);
    };
    if (points.empty() || points.size() % values != 0)
        refuse("points of " + std::to_string(values) + " numbers each, found " +
               std::to_string(points.size()) + " numbers");
    const auto broken =
        std::find_if_not(points.begin(), points.end(), [](float v) { return std::abs(v) <= 1e17f; });
    if (broken == points.end())
        return;
    const auto place = static_cast<std::size_t>(broken - points.begin());
    refuse("finite numbers of at most 1e17, found " + std::to_string(*broken) + " as number " +
           std::to_string(place % values) + " of point " + std::to_string(place / values) +
           " (counted from 0)");
}

} // namespace TACTNET_ARCH
} // namespace tactnet
