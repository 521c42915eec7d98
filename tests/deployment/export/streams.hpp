#pragma once

#include "networks.hpp"

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/quantisation.hpp>

#include <cstddef>
#include <vector>

// The streams that are written as headers. Generator and test make them alike.

/// Every kind of step, and sizes that fill no vector.
using recorded_network = tactnet::network<
    tactnet::shape{9, 1, 3}, tactnet::named<"first", tactnet::causal_conv1d<6, 3, 2>>, tactnet::relu,
    tactnet::residual<tactnet::sequence<tactnet::causal_conv1d<6, 2>, own::softsign<50>>>, tactnet::lstm<19>,
    tactnet::dropout<20>, tactnet::residual<tactnet::causal_conv1d<7, 1>, tactnet::causal_conv1d<7, 2>>,
    tactnet::silu, tactnet::gru<4>, tactnet::last_frame, tactnet::dense<2>>;
/// Outputs that are bytes.
using tagging_network = tactnet::network<tactnet::shape{9, 1, 5}, tactnet::gru<7>,
                                         tactnet::causal_conv1d<3, 2>, tactnet::sigmoid>;

/// Recordings of the network's length, frame by frame.
template <class Network>
std::vector<float> recordings(std::size_t count, std::size_t seed) {
    std::vector<float> all(count * Network::input_shape.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = static_cast<float>((i * i * 7 + seed * 31 + i * 11) % 97) / 32.0f - 1.5f;
    return all;
}
template <class Network>
auto deployed_stream_of(tactnet::single_precision) {
    return tactnet::deploy_stream(filled_network<Network>());
}
template <class Network>
auto deployed_stream_of(tactnet::eight_bit) {
    // Any order of numbers is as good as another.
    auto stream =
        tactnet::deploy_stream<tactnet::eight_bit>(filled_network<Network>(), recordings<Network>(8, 5));
    stream.set_temperature(0.7);
    return stream;
}
