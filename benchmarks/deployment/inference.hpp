#pragma once

#include "../peers/peer.hpp"
#include "../support/checked_network.hpp"
#include "../support/described_network.hpp"

#include <tactnet/quantisation.hpp>

#include <benchmark/benchmark.h>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

// Deployed inference and its peers: one network at one size, in batches of 1 and 64, in single precision
// and in 8 bits. Every implementation must give the logits of the network in double precision before it is
// timed, in 8 bits as nearly as bytes can, and the same bits afterwards.

namespace benchmark {

struct inference_case {
    std::string name; ///< for example tactnet6/28x50
    std::size_t multiply_adds_on_pixels;
};

/// All cases in this program, for the table after the benchmarks.
inline std::vector<inference_case>& inference_cases() {
    static std::vector<inference_case> cases;
    return cases;
}

/// Times body(), which fills `logits`, and refuses wrong ones.
template <class Body>
void time_checked(State& state, std::vector<float>& logits, const std::vector<double>& expected,
                  double tolerance, Body body) {
    body();
    const double error = error_of(logits, expected);
    if (!(error < tolerance)) {
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
    state.counters["error"] = error;
}

/// What rounds and benchmarks share, made when the first of them runs: it takes longer than they do.
template <class Make>
auto made_once(Make make) {
    using made = decltype(make());
    return [make, kept = std::make_shared<std::unique_ptr<const made>>()]() -> const made& {
        if (!*kept)
            *kept = std::make_unique<const made>(make());
        return **kept;
    };
}

/// Times `deployed` on the frames of a task.
template <class Network, class Count, class Deployed>
void time_deployed(State& state, const task<Network, Count>& given, const Deployed& deployed,
                   double tolerance) {
    std::vector<float> logits(given.expected.size());
    typename Deployed::workspace memory;
    tactnet::thread_pool one(1);
    time_checked(state, logits, given.expected, tolerance, [&] {
        const auto status =
            given.expected.size() == Network::outputs
                ? deployed.infer(tactnet::tensor_view<const Count, Network::input_shape>(given.frames.data()),
                                 std::span(logits).template first<Network::outputs>(), memory)
                : deployed.infer(std::span(given.frames), std::span(logits), one);
        if (status != tactnet::frame_status::ok)
            state.SkipWithError("a frame was not recognised");
    });
}

template <class Network>
void register_8bit_inference(const std::string& end, std::size_t batch) {
    const auto given = made_once([=] { return task<Network, std::uint8_t>(batch, -200, 255); });
    const auto deployed = made_once([=] {
        const std::vector<float> mean(Network::input_shape.size());
        return tactnet::deploy<tactnet::eight_bit>(
            given().network, std::span(mean).template first<Network::input_shape.size()>(), 1.0f,
            std::span<const std::uint8_t>(given().frames));
    });
    RegisterBenchmark(("tactnet_8bit/" + end).c_str(),
                      [=](State& state) { time_deployed(state, given(), deployed(), byte_tolerance); });
#ifdef TACTNET_BENCHMARK_ONEDNN
    const auto onednn = made_once(
        [=] { return make_onednn_8bit(described_network::of(given().network), batch, given().frames); });
    RegisterBenchmark(("onednn_8bit/" + end).c_str(), [=](State& state) {
        std::vector<float> logits(given().expected.size());
        byte_peer& theirs = *onednn();
        const std::vector<std::uint8_t>& frames = given().frames;
        time_checked(state, logits, given().expected, byte_tolerance, [&] { theirs.run(frames, logits); });
    });
#endif
}

template <class Network>
void register_inference(const std::string& name) {
    inference_cases().push_back({name, Network::multiply_adds_on_pixels});
    for (const std::size_t batch : {std::size_t{1}, std::size_t{64}}) {
        const std::string end = name + "/batch" + std::to_string(batch);
        const auto given = made_once([=] { return task<Network, float>(batch, -20, 100); });
        const auto deployed = made_once([=] { return tactnet::deploy(given().network); });
        RegisterBenchmark(("tactnet/" + end).c_str(),
                          [=](State& state) { time_deployed(state, given(), deployed(), float_tolerance); });
        for_each_library([=](const char* peer_name, auto make) {
            const auto made = made_once([=] { return make(described_network::of(given().network), batch); });
            RegisterBenchmark((peer_name + ("/" + end)).c_str(), [=](State& state) {
                std::vector<float> logits(given().expected.size());
                peer& theirs = *made();
                const std::vector<float>& frames = given().frames;
                time_checked(state, logits, given().expected, float_tolerance,
                             [&] { theirs.run(frames, logits); });
            });
        });
        register_8bit_inference<Network>(end, batch);
    }
}

} // namespace benchmark
