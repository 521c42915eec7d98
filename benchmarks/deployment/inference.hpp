#pragma once

#include "../peers/peer.hpp"
#include "../support/described_network.hpp"

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/training/initialise.hpp>

#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

// Deployed inference beside its peers: one network at one size, in batches of 1 and 64, in single precision
// and in 8 bits. Every implementation must give the logits of the network in double precision before it is
// timed, in 8 bits as nearly as bytes can, and the same bits afterwards.

namespace benchmark {

struct inference_case {
    std::string name; ///< for example tactnet6/28x50
    std::size_t multiply_adds_on_pixels;
};

/// All cases in this program, for the table behind the benchmarks.
inline std::vector<inference_case>& inference_cases() {
    static std::vector<inference_case> cases;
    return cases;
}

/// A network as after training: random weights, statistics that differ from channel to channel.
template <class Network>
Network trained_network() {
    Network network;
    tactnet::initialise(network, tactnet::he_normal{}, 1);
    tactnet::random_stream random(2, tactnet::draw::order);
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
    exact.infer(one, space, in, out);
    std::vector<double> logits;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t o = 0; o < Network::outputs; ++o)
            logits.push_back(out(i, o));
    return logits;
}

/// Largest errors of logits, as shares of the largest logit. In 8 bits: an order of magnitude above what is
/// seen, and below what one wrong weight in a hundred makes.
inline constexpr double float_tolerance = 1e-4, byte_tolerance = 0.1;

/// Times body(), which fills `logits`, and refuses wrong ones.
template <class Body>
void time_checked(State& state, std::vector<float>& logits, const std::vector<double>& expected,
                  double tolerance, Body body) {
    body();
    double error = 0, largest = 0;
    for (std::size_t i = 0; i < logits.size(); ++i) {
        error = std::max(error, std::abs(static_cast<double>(logits[i]) - expected[i]));
        largest = std::max(largest, std::abs(expected[i]));
    }
    if (!(error < tolerance * largest)) {
        state.SkipWithError("wrong logits");
        return;
    }
    const std::vector<float> first = logits;
    for (auto _ : state) {
        body();
        ClobberMemory();
    }
    if (first != logits)
        state.SkipWithError("logits differ from run to run");
    state.counters["error"] = error / largest;
}

template <class Network>
void register_8bit_inference(const std::string& end, std::size_t batch) {
    const auto make_frames = [batch] {
        std::vector<std::uint8_t> frames(batch * Network::input_shape.size());
        tactnet::random_stream random(3, tactnet::draw::order);
        for (std::uint8_t& f : frames)
            f = static_cast<std::uint8_t>(std::max(random.uniform(-200, 255), 0.0));
        return frames;
    };
    RegisterBenchmark(("tactnet_8bit/" + end).c_str(), [=](State& state) {
        const auto network = trained_network<Network>();
        const std::vector<std::uint8_t> frames = make_frames();
        std::vector<float> logits(batch * Network::outputs);
        const std::vector<float> mean(Network::input_shape.size());
        const auto deployed = tactnet::deploy<tactnet::eight_bit>(
            network, std::span(mean).template first<Network::input_shape.size()>(), 1.0f,
            std::span<const std::uint8_t>(frames));
        typename decltype(deployed)::scratch memory;
        tactnet::thread_pool one(1);
        time_checked(state, logits, exact_logits(network, std::vector<float>(frames.begin(), frames.end())),
                     byte_tolerance, [&] {
                         const auto status =
                             batch == 1
                                 ? deployed(tactnet::tensor_view<const std::uint8_t, Network::input_shape>(
                                                frames.data()),
                                            std::span(logits).template first<Network::outputs>(), memory)
                                 : deployed(one, std::span(frames), std::span(logits));
                         if (status != tactnet::frame_status::recognised)
                             state.SkipWithError("a frame was not recognised");
                     });
    });
#ifdef TACTNET_BENCHMARK_ONEDNN
    RegisterBenchmark(("onednn_8bit/" + end).c_str(), [=](State& state) {
        const auto network = trained_network<Network>();
        const std::vector<std::uint8_t> frames = make_frames();
        std::vector<float> logits(batch * Network::outputs);
        const auto onednn = make_onednn_8bit(described_network::of(network), batch, frames);
        time_checked(state, logits, exact_logits(network, std::vector<float>(frames.begin(), frames.end())),
                     byte_tolerance, [&] { onednn->run(frames, logits); });
    });
#endif
}

template <class Network>
void register_inference(const std::string& name) {
    inference_cases().push_back({name, Network::multiply_adds_on_pixels});
    for (const std::size_t batch : {std::size_t{1}, std::size_t{64}}) {
        const std::string end = name + "/batch" + std::to_string(batch);
        const auto make_frames = [batch] {
            std::vector<float> frames(batch * Network::input_shape.size());
            tactnet::random_stream random(3, tactnet::draw::order);
            for (float& f : frames)
                f = static_cast<float>(random.uniform(-20, 100));
            return frames;
        };
        RegisterBenchmark(("tactnet/" + end).c_str(), [=](State& state) {
            const auto network = trained_network<Network>();
            const std::vector<float> frames = make_frames();
            std::vector<float> logits(batch * Network::outputs);
            const auto deployed = tactnet::deploy(network);
            typename decltype(deployed)::scratch memory;
            tactnet::thread_pool one(1);
            time_checked(state, logits, exact_logits(network, frames), float_tolerance, [&] {
                const auto status =
                    batch == 1
                        ? deployed(tactnet::tensor_view<const float, Network::input_shape>(frames.data()),
                                   std::span(logits).template first<Network::outputs>(), memory)
                        : deployed(one, std::span(frames), std::span(logits));
                if (status != tactnet::frame_status::recognised)
                    state.SkipWithError("a frame was not recognised");
            });
        });
#ifdef TACTNET_BENCHMARK_ONEDNN
        RegisterBenchmark(("onednn/" + end).c_str(), [=](State& state) {
            const auto network = trained_network<Network>();
            const std::vector<float> frames = make_frames();
            std::vector<float> logits(batch * Network::outputs);
            const auto onednn = make_onednn(described_network::of(network), batch);
            time_checked(state, logits, exact_logits(network, frames), float_tolerance,
                         [&] { onednn->run(frames, logits); });
        });
#endif
        register_8bit_inference<Network>(end, batch);
    }
}

} // namespace benchmark
