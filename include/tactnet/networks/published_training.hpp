#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <optional>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Of a network whose weights were learnt from photographs and are trained on (the paper's TL-NN).
struct published_transfer {
    std::size_t epochs, batch;
    double new_layer_factor; ///< how many times the rate of the others the new last layer learns by
};

/// What a network's published training has of its own. All else is common: see recipe::published, which takes
/// this.
struct published_training {
    double rate;                     ///< first learning rate, that of a new last layer
    double drop_period;              ///< epochs after which the rate is multiplied by drop_factor; 0 is never
    std::size_t patience;            ///< validations without a smaller loss before it stops
    double drop_factor = 0.1;        ///< of the rate, each time
    std::size_t validate_every = 10; ///< epochs
    bool subtracts_mean = true;      ///< of the training images; else counts come as they are
    std::optional<published_transfer> transfer = {};
};

} // namespace TACTNET_ARCH
} // namespace tactnet
