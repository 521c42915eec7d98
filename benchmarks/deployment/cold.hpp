#pragma once

#include "../peers/peer.hpp"
#include "../support/checked_network.hpp"
#include "../support/described_network.hpp"

#include <tactnet/quantisation.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// One frame through a network, for calls that find nothing of it in the caches: the network in each library
// and both number formats. Each must give the logits in double precision before it is timed.

namespace benchmark {

/// A network in one library.
struct cold_contender {
    std::string library;
    std::vector<float> logits, first; ///< of the last call, and of the one that was checked
    std::function<void(std::span<float>)> infer;

    void call() { infer(logits); }
    [[nodiscard]] bool same() const { return logits == first; }
};
/// A network in one number format.
struct cold_case {
    std::string name, format;
    std::size_t parameters, packed, workspace; ///< bytes: in a file, as tactnet reads them, of memory
    std::function<std::vector<cold_contender>()> make;
};
/// All networks of this program.
inline std::vector<cold_case>& cold_cases() {
    static std::vector<cold_case> cases;
    return cases;
}

/// Adds a library to those of a case. Throws std::runtime_error if its logits are wrong.
inline void add_contender(std::vector<cold_contender>& to, const char* library,
                          const std::vector<double>& expected, double tolerance,
                          std::function<void(std::span<float>)> infer) {
    cold_contender one{library, std::vector<float>(expected.size()), {}, std::move(infer)};
    one.call();
    if (!(error_of(one.logits, expected) < tolerance))
        throw std::runtime_error(std::string("wrong logits: ") + library);
    one.first = one.logits;
    to.push_back(std::move(one));
}

/// A deployed network that writes the logits of the frame of a task.
template <class Network, class Count, class Deployed>
[[nodiscard]] auto inference_of(std::shared_ptr<const task<Network, Count>> given, Deployed deployed) {
    return [given, deployed = std::make_shared<const Deployed>(std::move(deployed)),
            memory = std::make_shared<typename Deployed::workspace>()](std::span<float> logits) {
        if (deployed->infer(tactnet::tensor_view<const Count, Network::input_shape>(given->frames.data()),
                            logits.first<Network::outputs>(), *memory) != tactnet::frame_status::ok)
            throw std::runtime_error("tactnet: the frame was not recognised");
    };
}

template <class Network>
void register_cold_calls(const std::string& name) {
    using floats = tactnet::deployed<Network>;
    using bytes = tactnet::deployed<Network, tactnet::eight_bit>;
    cold_cases().push_back(
        {name, "float", Network::parameters * sizeof(float), floats::weight_bytes, floats::workspace_bytes,
         [] {
             const auto given = std::make_shared<const task<Network, float>>(1, -20, 100);
             std::vector<cold_contender> all;
             add_contender(all, "tactnet", given->expected, float_tolerance,
                           inference_of(given, tactnet::deploy(given->network)));
             for_each_library([&](const char* library, auto make) {
                 const std::shared_ptr<peer> one = make(described_network::of(given->network), 1);
                 add_contender(all, library, given->expected, float_tolerance,
                               [given, one](std::span<float> logits) { one->run(given->frames, logits); });
             });
             return all;
         }});
    cold_cases().push_back(
        {name, "8 bits", Network::parameters, bytes::weight_bytes, bytes::workspace_bytes, [] {
             const auto given = std::make_shared<const task<Network, std::uint8_t>>(1, -200, 255);
             const std::vector<float> mean(Network::input_shape.size());
             std::vector<cold_contender> all;
             add_contender(
                 all, "tactnet", given->expected, byte_tolerance,
                 inference_of(given, tactnet::deploy<tactnet::eight_bit>(
                                         given->network,
                                         std::span(mean).template first<Network::input_shape.size()>(), 1.0f,
                                         std::span<const std::uint8_t>(given->frames))));
#ifdef TACTNET_BENCHMARK_ONEDNN
             const std::shared_ptr<byte_peer> one =
                 make_onednn_8bit(described_network::of(given->network), 1, given->frames);
             add_contender(all, "onednn", given->expected, byte_tolerance,
                           [given, one](std::span<float> logits) { one->run(given->frames, logits); });
#endif
             return all;
         }});
}

} // namespace benchmark
