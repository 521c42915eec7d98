#pragma once

// A deployed network of any number format behind virtual functions. Included by the generated units only.

#include "methods/networks/compiled.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>

#include <span>
#include <string>
#include <utility>

template <class Network, class Format>
class deployed_network final : public any_deployed {
public:
    explicit deployed_network(tactnet::deployed<Network, Format> own) : own_(std::move(own)) {}

    bool recognise(tactnet::thread_pool& threads, std::span<const std::uint8_t> frames,
                   std::span<float> outputs) const override {
        return own_.infer(frames, outputs, threads) == tactnet::frame_status::ok;
    }
    bool gives_probabilities() const override { return Network::ends_in_softmax; }
    std::string header(const tactnet::header_description& says,
                       std::span<const std::uint8_t> frame) const override {
        return tactnet::deployed_header(own_, says, frame.first<Network::input_shape.size()>());
    }

private:
    tactnet::deployed<Network, Format> own_;
};
