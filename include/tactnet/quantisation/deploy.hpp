#pragma once

#include <tactnet/deployment/deployed_model.hpp>
#include <tactnet/quantisation/calibration.hpp>

#include <cstdint>
#include <span>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A trained network in 8 bits, for inputs (count − mean) × scale. `images` are training images one behind
/// the other, [channel][row][column], bytes or floats: they tell which numbers its maps hold. Throws
/// std::invalid_argument as eight_bit_calibration.
template <class Format, class Network, class Count>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed<Network, eight_bit> deploy(const Network& network,
                                                  std::span<const float, Network::input_shape.size()> mean,
                                                  float scale, std::span<const Count> images) {
    return deployed<Network, eight_bit>(
        eight_bit_calibration<Network>(network, mean, scale, images).folded());
}

/// The same of a model, which names its classes:
///
///     const auto recognise = deploy<eight_bit>(model, training_images);
template <class Format, class Network, class Count>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed_model<Network, eight_bit> deploy(const model<Network>& trained,
                                                        std::span<const Count> images) {
    return {deploy<eight_bit>(trained.network, trained.normalise.mean.view().elements(),
                              trained.normalise.scale, images),
            trained.classes};
}

} // namespace TACTNET_ARCH
} // namespace tactnet
