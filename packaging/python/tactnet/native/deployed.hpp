#pragma once

#include "described.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>

#include <utility>

namespace tactnet_python {

template <class Network, class Format>
class deployed_network final : public any_deployed {
    using network_type = tactnet::deployed<Network, Format>;
    static constexpr std::size_t pixels = Network::input_shape.size(), outputs = network_type::outputs;

public:
    explicit deployed_network(network_type own) : own_(std::move(own)) {
        weight_bytes = network_type::weight_bytes, workspace_bytes = network_type::workspace_bytes;
    }
    tactnet::frame_status infer(const frames_view& frames, std::span<float> to,
                                std::size_t threads) const override {
        return frames.are_counts ? infer_as<std::uint8_t>(frames, to, threads)
                                 : infer_as<float>(frames, to, threads);
    }
    std::string header(const tactnet::header_description& description, double temperature,
                       const tactnet::reflection_rule& reflections,
                       std::span<const std::uint8_t> frame) const override {
        network_type own = own_;
        own.set_temperature(temperature), own.set_reflections(reflections);
        return tactnet::deployed_header(own, description, frame.first<pixels>());
    }
    std::span<const float> folded() const override { return own_.folded(); }

private:
    template <class Element>
    tactnet::frame_status infer_as(const frames_view& frames, std::span<float> to,
                                   std::size_t threads) const {
        const std::span all(static_cast<const Element*>(frames.elements), frames.count * pixels);
        if constexpr (network_type::workspace_bytes <= network_type::view_type::max_stack_bytes)
            if (frames.count == 1)
                return own_.infer(all.template first<pixels>(), to.first<outputs>());
        tactnet::thread_pool pool(threads);
        return own_.infer(all, to, pool);
    }
    network_type own_;
};

template <class Network>
network_code code_of_deployed() {
    network_code code;
    code.facts = facts_of<Network>;
    code.deploy = [](const trained_numbers& numbers) -> std::unique_ptr<any_deployed> {
        const auto network = network_of<Network>(numbers);
        tactnet::detail::check_trained("deploy", *network);
        return std::make_unique<deployed_network<Network, tactnet::single_precision>>(
            tactnet::deploy(*network, mean_of<Network>(numbers), numbers.scale));
    };
    return code;
}

} // namespace tactnet_python
