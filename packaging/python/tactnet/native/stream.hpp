#pragma once

#include "described.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/deployment/stream.hpp>
#include <tactnet/quantisation/stream_calibration.hpp>

#include <utility>

namespace tactnet_python {

template <class Stream>
class stream_network final : public any_stream {
    using state_type = typename Stream::state;

public:
    explicit stream_network(Stream own) : own_(std::move(own)) {
        features = Stream::features, outputs = Stream::outputs;
    }
    std::size_t run(std::span<const float> frames, std::span<float> to) override {
        return own_.run(frames, state_, to);
    }
    void reset() override { state_ = {}; }
    std::vector<std::byte> state() const override {
        constexpr std::size_t size = tactnet::saved_state_bytes<state_type>;
        std::vector<std::byte> bytes(size);
        tactnet::save_state(state_, std::span(bytes).template first<size>());
        return bytes;
    }
    bool restore(std::span<const std::byte> state) override {
        return own_.restore_state(state, state_) == tactnet::restore_status::ok;
    }
    std::string header(const tactnet::header_description& description,
                       std::span<const float> recording) const override {
        return tactnet::deployed_header(own_, description, recording);
    }

private:
    Stream own_;
    state_type state_{};
};

template <class Network>
network_code code_of_stream() {
    network_code code;
    code.facts = facts_of<Network>;
    code.stream = [](const trained_numbers& numbers) -> std::unique_ptr<any_stream> {
        return std::make_unique<stream_network<tactnet::deployed_stream<Network>>>(
            tactnet::deploy_stream(*network_of<Network>(numbers)));
    };
    code.stream_in_8_bits = [](const trained_numbers& numbers,
                               std::span<const float> sequences) -> std::unique_ptr<any_stream> {
        return std::make_unique<stream_network<tactnet::deployed_stream<Network, tactnet::eight_bit>>>(
            tactnet::deploy_stream<tactnet::eight_bit>(*network_of<Network>(numbers), sequences));
    };
    return code;
}

} // namespace tactnet_python
