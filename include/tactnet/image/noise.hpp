#pragma once

#include <tactnet/kernels/random.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <cmath>

namespace tactnet::inline TACTNET_ARCH {

/// How far counts scatter from touch to touch, as standard deviations.
struct pressure_noise {
    double additive = 0; ///< counts
    double relative = 0; ///< share of each count

    friend constexpr bool operator==(const pressure_noise&, const pressure_noise&) = default;
};

/// Adds normal noise to counts, each tactel's its own; none falls below zero, and NaN stays. The numbers come
/// one after the other from the stream: of (seed, draw::noise, epoch, sample) they are the same wherever they
/// are computed.
template <shape Shape>
void add_noise(const pressure_noise& noise, random_stream random, tensor_view<float, Shape> counts) {
    if (noise == pressure_noise{})
        return;
    for (float& count : counts.elements()) {
        const double value = static_cast<double>(count);
        const float noisy =
            static_cast<float>(value + std::hypot(noise.additive, noise.relative * value) * random.normal());
        count = noisy < 0 ? 0 : noisy;
    }
}

} // namespace tactnet
