#pragma once

// Recordings for the tests of streams, and what a network computes of them, in one batch or frame by frame.

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/stream.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <cstddef>
#include <span>
#include <support/drawn_network.hpp>
#include <vector>

namespace support {

/// Recordings, each `frames` times `features` numbers.
inline std::vector<std::vector<float>> recordings(std::size_t count, std::size_t frames,
                                                  std::size_t features) {
    tactnet::random_stream random(2, tactnet::random_purposes::order, 0);
    std::vector<std::vector<float>> result(count, std::vector<float>(frames * features));
    for (std::vector<float>& each : result)
        for (float& value : each)
            value = static_cast<float>(random.uniform(-2, 2));
    return result;
}
/// What the network computes for whole recordings, in one batch: after each frame `outputs` numbers, or once.
template <class Network>
std::vector<std::vector<float>>
in_batch(const Network& network, const std::vector<std::vector<float>>& sequences, std::size_t threads) {
    constexpr tactnet::shape in_shape = Network::input_shape, out_shape = Network::output_shape;
    typename Network::input_batch in(sequences.size());
    typename Network::output_batch out(sequences.size());
    for (std::size_t s = 0; s < sequences.size(); ++s)
        for (std::size_t frame = 0; frame < in_shape.rows; ++frame)
            for (std::size_t f = 0; f < in_shape.channels; ++f)
                in(s, f * in_shape.rows + frame) = sequences[s][frame * in_shape.channels + f];
    tactnet::thread_pool pool(threads);
    typename Network::workspace space;
    network.prepare(pool, space);
    network.logits(in, out, pool, space);
    std::vector<std::vector<float>> result(sequences.size());
    for (std::size_t s = 0; s < sequences.size(); ++s)
        for (std::size_t frame = 0; frame < out_shape.rows; ++frame)
            for (std::size_t o = 0; o < out_shape.channels; ++o)
                result[s].push_back(out(s, o * out_shape.rows + frame));
    return result;
}
template <class Network>
std::vector<float> in_stream(const tactnet::deployed_stream<Network>& stream,
                             std::span<const float> recording) {
    std::vector<float> outputs(recording.size() / stream.features * stream.outputs);
    typename tactnet::deployed_stream<Network>::state memory;
    outputs.resize(stream.run(recording, memory, outputs) * stream.outputs);
    return outputs;
}

} // namespace support
