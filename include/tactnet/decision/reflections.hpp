#pragma once

#include <tactnet/networks/recognition.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Runs a deployed network on a frame and on its three reflections, and writes the means of their logits and
/// of their features: reflection_average, with the features by which unknown objects are found. Takes four
/// times as long as `infer`. Returns its frame_status: not_finite if an output of one of the four is.
template <class Network>
auto infer_reflections(const Network& network,
                       std::span<const std::uint8_t, Network::input_shape.size()> frame,
                       std::span<float, Network::outputs> logits,
                       std::span<float, Network::features> features,
                       typename Network::workspace& memory) noexcept {
    std::array<std::uint8_t, Network::input_shape.size()> reflected;
    std::array<std::array<float, Network::outputs>, all_reflections.size()> of_logits;
    std::array<std::array<float, Network::features>, all_reflections.size()> of_features;
    using status_type = decltype(network.infer(reflected, of_logits[0], memory));
    status_type status = status_type::ok;
    for (std::size_t i = 0; i < all_reflections.size(); ++i) {
        reflect_image(Network::input_shape, all_reflections[i], frame.data(), reflected.data());
        if (network.infer(reflected, of_logits[i], memory) != status_type::ok)
            status = status_type::not_finite;
        network.read_features(memory, of_features[i]);
    }
    const auto average = [](const auto& outputs_per_reflection, std::span<float> to) {
        for (std::size_t e = 0; e < to.size(); ++e)
            to[e] = mean_of_reflections(outputs_per_reflection[0][e], outputs_per_reflection[1][e],
                                        outputs_per_reflection[2][e], outputs_per_reflection[3][e]);
    };
    average(of_logits, logits);
    average(of_features, features);
    return status;
}

}} // namespace tactnet
