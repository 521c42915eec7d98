#pragma once

#include "../peers/peer.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

// A large network, deployed and in a peer: what large_networks.cpp measures, and
// large_networks_unit.cpp.in makes, one unit a network.

namespace benchmark {

/// Both with the same random weights, for batches of one size.
struct large_network {
    std::size_t inputs, outputs; ///< elements of a frame and of its result
    std::size_t longest_sums;    ///< terms of one output of each layer, all layers together
    std::function<void(std::span<const float> frames, std::span<float> results)> deployed;
    std::unique_ptr<benchmark::peer> peer;
    /// Both in 8 bits, made when wanted; empty where a network is not measured in 8 bits.
    std::function<void(std::span<const std::uint8_t> frames, std::span<float> results)> deployed_8bit;
    std::function<std::unique_ptr<byte_peer>(std::span<const std::uint8_t> frames)> make_peer_8bit;
};

struct large_network_case {
    std::string name; ///< for example resnet50
    large_network (*make)(std::size_t batch, std::size_t threads);
};

/// All cases in this program. Units register theirs before main() begins.
inline std::vector<large_network_case>& large_network_cases() {
    static std::vector<large_network_case> cases;
    return cases;
}

} // namespace benchmark
