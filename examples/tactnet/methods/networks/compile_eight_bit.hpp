#pragma once

// Compiles a network's form in 8 bits for the program. Included by the generated units only: those who want
// no such form do not pay for it.

#include "methods/networks/compile.hpp"

#include <tactnet/quantisation.hpp>

template <class Network>
class eight_bit_code final : public compiled_eight_bit {
    using bytes = tactnet::deployed<Network, tactnet::eight_bit>;
    static constexpr std::size_t numbers = bytes::view_type::folded_elements;

public:
    tactnet::folded_layout layout() const override {
        return tactnet::folded_layout_of<typename bytes::view_type>();
    }
    calibrated_numbers calibrate(const any_model& model,
                                 std::span<const std::uint8_t> images) const override {
        const auto network = std::make_unique<Network>();
        std::ranges::copy(model.network->learnable_values(), network->learnable_values().begin());
        std::ranges::copy(model.network->running_statistics(), network->running_statistics().begin());
        network->epsilon = model.network->epsilon();
        const tactnet::eight_bit_calibration<Network> calibration(
            *network, std::span(model.mean).template first<Network::input_shape.size()>(), model.scale,
            images, model.function);
        return {{calibration.folded().begin(), calibration.folded().end()},
                calibration.output_error(),
                calibration.output_error_of_rounded()};
    }
    std::unique_ptr<any_deployed> deploy(std::span<const float> folded,
                                         const std::vector<std::string>& classes, double temperature,
                                         const tactnet::input_function& function,
                                         const tactnet::reflection_rule& reflections) const override {
        return std::make_unique<deployed_network<Network, tactnet::eight_bit>>(
            bytes(folded.template first<numbers>()), classes, temperature, function, reflections);
    }
};
