#pragma once

#include "interface.hpp"

#include <tactnet/networks/network.hpp>

#include <algorithm>

namespace tactnet_python {

template <class Network>
network_facts facts_of() {
    return {Network::input_shape,
            Network::output_shape,
            Network::describe(),
            Network::parameters,
            Network::statistics,
            Network::multiply_adds,
            Network::multiply_adds_on_pixels,
            Network::activation_bytes,
            Network::needs_counts,
            Network::ends_in_softmax};
}

/// A network with the given numbers.
template <class Network>
std::unique_ptr<Network> network_of(const trained_numbers& numbers) {
    auto network = std::make_unique<Network>();
    network->epsilon = numbers.epsilon;
    std::size_t index = 0;
    network->for_each_parameter([&](const tactnet::parameter&, std::span<float> to) {
        const std::vector<float>& from = numbers.arrays.at(index++);
        std::fill(std::copy(from.begin(), from.end(), to.begin()), to.end(), 0.0F);
    });
    return network;
}

template <class Network>
network_code code_of_described() {
    network_code code;
    code.facts = facts_of<Network>;
    return code;
}

template <class Network>
std::span<const float, Network::input_shape.size()> mean_of(const trained_numbers& numbers) {
    return std::span(numbers.mean).template first<Network::input_shape.size()>();
}

} // namespace tactnet_python
