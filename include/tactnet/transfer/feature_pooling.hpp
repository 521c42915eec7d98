#pragma once

#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <span>

// From the map that a trunk ends in to one row of numbers.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What of a map becomes features.
enum class feature_pooling {
    none,    ///< every value, as in the paper
    maximum, ///< the largest of each channel: whether something is seen, wherever
    average  ///< the mean of each channel: how much of it is seen
};

/// How many features a map gives.
[[nodiscard]] constexpr std::size_t feature_count(feature_pooling pooling, shape map) {
    return pooling == feature_pooling::none ? map.size() : map.channels;
}

/// `map` is [channel][row][column]; `to` has room for feature_count(pooling, extents) numbers.
inline void pool_features(feature_pooling pooling, std::span<const float> map, shape extents,
                          std::span<float> to) {
    if (pooling == feature_pooling::none) {
        std::copy(map.begin(), map.end(), to.begin());
        return;
    }
    for (std::size_t channel = 0; channel < extents.channels; ++channel) {
        const auto plane = map.subspan(channel * extents.area(), extents.area());
        if (pooling == feature_pooling::maximum) {
            to[channel] = *std::max_element(plane.begin(), plane.end());
        } else {
            double sum = 0;
            for (const float value : plane)
                sum += static_cast<double>(value);
            to[channel] = static_cast<float>(sum / static_cast<double>(plane.size()));
        }
    }
}

} // namespace TACTNET_ARCH
} // namespace tactnet
