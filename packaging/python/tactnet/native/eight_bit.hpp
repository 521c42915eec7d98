#pragma once

#include "deployed.hpp"

#include <tactnet/quantisation/calibration.hpp>

namespace tactnet_python {

template <class Network>
network_code code_of_eight_bit() {
    using deployed_type = tactnet::deployed<Network, tactnet::eight_bit>;
    network_code code;
    code.facts = facts_of<Network>;
    code.layout = [] { return tactnet::folded_layout_of<typename deployed_type::view_type>(); };
    code.calibrate = [](const trained_numbers& numbers, const frames_view& images) {
        const auto network = network_of<Network>(numbers);
        tactnet::detail::check_trained("deploy", *network);
        const auto found = [&]<class Element>(const Element* elements) {
            const tactnet::eight_bit_calibration<Network> calibration(
                *network, mean_of<Network>(numbers), numbers.scale,
                std::span(elements, images.count * Network::input_shape.size()), numbers.function);
            return std::vector<float>(calibration.folded().begin(), calibration.folded().end());
        };
        return images.are_counts ? found(static_cast<const std::uint8_t*>(images.elements))
                                 : found(static_cast<const float*>(images.elements));
    };
    code.deploy_folded = [](std::span<const float> folded,
                            const tactnet::input_function& function) -> std::unique_ptr<any_deployed> {
        return std::make_unique<deployed_network<Network, tactnet::eight_bit>>(
            deployed_type(folded.first<deployed_type::view_type::folded_elements>()), function);
    };
    return code;
}

} // namespace tactnet_python
