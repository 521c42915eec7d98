#pragma once

#include <tactnet/operators/layer.hpp>
#include <tactnet/runtime/random.hpp>

#include <cmath>
#include <cstdint>
#include <span>

namespace support {

/// A network whose numbers are drawn, weights so that values keep their size.
template <class Network>
Network drawn_network(std::uint32_t seed = 1) {
    Network network;
    tactnet::random_stream random(seed, tactnet::random_purposes::order, 0);
    network.for_each_parameter([&](const tactnet::parameter& p, std::span<float> values) {
        const double size = 1.5 / std::sqrt(static_cast<double>(p.fan_in));
        for (float& value : values)
            value = static_cast<float>(random.uniform(-size, size));
    });
    return network;
}

} // namespace support
