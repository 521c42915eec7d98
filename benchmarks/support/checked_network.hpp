#pragma once

#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/training/initialise.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

// A network with random numbers, frames, and the logits in double precision that every implementation of it
// must give before it is timed.

namespace benchmark {

/// A network as after training: random weights, statistics that differ from channel to channel.
template <class Network>
Network trained_network() {
    Network network;
    tactnet::initialise(network, tactnet::he_normal{}, 1);
    tactnet::random_stream random(2, tactnet::random_purposes::order);
    for (float& s : network.running_statistics())
        s = static_cast<float>(random.uniform(0.5, 2));
    for (float& v : network.learnable_values())
        v += static_cast<float>(random.uniform(-0.02, 0.02));
    return network;
}

template <class Network>
std::vector<double> exact_logits(const Network& network, const std::vector<float>& frames) {
    using exact_network = typename Network::template with_value_type<double>;
    exact_network exact;
    std::copy_n(network.learnable_values().begin(), Network::parameters, exact.learnable_values().begin());
    std::copy_n(network.running_statistics().begin(), Network::statistics,
                exact.running_statistics().begin());
    const std::size_t count = frames.size() / Network::input_shape.size();
    tactnet::thread_pool one(1);
    typename exact_network::workspace space;
    typename exact_network::input_batch in(count);
    typename exact_network::output_batch out(count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t e = 0; e < Network::input_shape.size(); ++e)
            in(i, e) = static_cast<double>(frames[i * Network::input_shape.size() + e]);
    exact.prepare(one, space);
    exact.infer(in, out, one, space);
    std::vector<double> logits;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t o = 0; o < Network::outputs; ++o)
            logits.push_back(out(i, o));
    return logits;
}

/// Largest errors of logits, as shares of the largest logit. In 8 bits: an order of magnitude above what is
/// seen, and below what one wrong weight in a hundred makes.
inline constexpr double float_tolerance = 1e-4, byte_tolerance = 0.1;

/// The largest error, as a share of the largest logit.
[[nodiscard]] inline double error_of(std::span<const float> logits, const std::vector<double>& expected) {
    double error = 0, largest = 0;
    for (std::size_t i = 0; i < logits.size(); ++i) {
        if (!std::isfinite(logits[i]))
            return std::numeric_limits<double>::infinity();
        error = std::max(error, std::abs(static_cast<double>(logits[i]) - expected[i]));
        largest = std::max(largest, std::abs(expected[i]));
    }
    return error / largest;
}

/// A network, frames, and its outputs for them in double precision.
template <class Network, class Count>
struct task {
    Network network = trained_network<Network>();
    std::vector<Count> frames;
    std::vector<double> expected;

    task(std::size_t batch, double low, double high) : frames(batch * Network::input_shape.size()) {
        tactnet::random_stream random(3, tactnet::random_purposes::order);
        for (Count& f : frames) {
            const double value = random.uniform(low, high);
            f = static_cast<Count>(std::is_same_v<Count, float> ? value : std::max(value, 0.0));
        }
        expected = exact_logits(network, std::vector<float>(frames.begin(), frames.end()));
    }
};

} // namespace benchmark
