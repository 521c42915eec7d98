#pragma once

#include "described.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <array>
#include <memory>
#include <utility>

namespace tactnet_python {

/// What the last layer reads, if these are single numbers: view_type::features, or else 0.
template <class View>
inline constexpr std::size_t features_of = 0;
template <tactnet::shape Input, class Steps>
inline constexpr std::size_t features_of<tactnet::deployed_view<Input, Steps>> =
    Steps::penultimate::number_elements == 1 ? tactnet::deployed_view<Input, Steps>::features : 0;

template <class Network, class Format>
class deployed_network final : public any_deployed {
    using network_type = tactnet::deployed<Network, Format>;
    static constexpr std::size_t pixels = Network::input_shape.size(), outputs = network_type::outputs,
                                 width = features_of<typename network_type::view_type>;

public:
    deployed_network(network_type own, const tactnet::input_function& function) : own_(std::move(own)) {
        own_.set_input_function(function);
        weight_bytes = network_type::weight_bytes, workspace_bytes = network_type::workspace_bytes;
        features = width;
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
    tactnet::frame_status read_features(const frames_view& frames, std::span<float> to) const override {
        return frames.are_counts ? features_as<std::uint8_t>(frames, to) : features_as<float>(frames, to);
    }

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
    template <class Element>
    tactnet::frame_status features_as(const frames_view& frames, std::span<float> to) const {
        auto status = tactnet::frame_status::ok;
        if constexpr (width > 0) {
            const auto memory = std::make_unique<typename network_type::workspace>();
            const auto view = own_.view();
            std::array<float, outputs> logits;
            const std::span all(static_cast<const Element*>(frames.elements), frames.count * pixels);
            for (std::size_t i = 0; i < frames.count; ++i) {
                const auto found =
                    view.infer(all.subspan(i * pixels).template first<pixels>(), logits, *memory);
                if (found != tactnet::frame_status::ok)
                    status = found;
                view.read_features(*memory, to.subspan(i * width).template first<width>());
            }
        }
        return status;
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
            tactnet::deploy(*network, mean_of<Network>(numbers), numbers.scale), numbers.function);
    };
    return code;
}

} // namespace tactnet_python
