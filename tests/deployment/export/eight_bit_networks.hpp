#pragma once

#include "networks.hpp"

#include <tactnet/quantisation.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Networks in 8 bits that are written as headers. Generator and tests make them alike.

/// Calibrated on a few frames.
template <class Network>
tactnet::deployed<Network, tactnet::eight_bit> deployed_in_8_bits() {
    const auto net = filled_network<Network>();
    const auto mean = mean_of<Network>();
    std::vector<std::uint8_t> images;
    for (std::size_t i = 0; i < 12; ++i) {
        const auto frame = frame_of<Network>(i);
        images.insert(images.end(), frame.begin(), frame.end());
    }
    return tactnet::deploy<tactnet::eight_bit>(net, mean.view().elements(), 1.0f / 64,
                                               std::span<const std::uint8_t>(images));
}
