#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What a network's published training has of its own. All else is common: see recipe::published, which takes
/// this.
struct published_training {
    double rate;          ///< first learning rate
    double drop_period;   ///< epochs after which the rate falls to a tenth; 0 is never
    std::size_t patience; ///< validations without a smaller loss before it stops
};

} // namespace TACTNET_ARCH
} // namespace tactnet
