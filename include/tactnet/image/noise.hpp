#pragma once

#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose noise{6}; ///< noise of one image in one epoch
} // namespace random_purposes

/// Standard deviations of the noise of counts.
struct pressure_noise {
    double additive = 0; ///< counts
    double relative = 0; ///< fraction of each count

    friend constexpr bool operator==(const pressure_noise&, const pressure_noise&) = default;
};

/// Adds independent normal noise to counts and clamps them at zero; NaN stays. With the stream of
/// (seed, random_purposes::noise, epoch, sample) the noise does not depend on where it is computed.
template <shape Shape>
void add_noise(const pressure_noise& noise, const random_stream& random, tensor_view<float, Shape> counts) {
    if (noise == pressure_noise{})
        return;
    kernels::normal_numbers(random).each(Shape.size(), [&](std::size_t tactel, float number) {
        float& count = counts.data()[tactel];
        const double value = static_cast<double>(count), share = noise.relative * value;
        const double deviation = std::sqrt(noise.additive * noise.additive + share * share);
        const auto noisy = static_cast<float>(value + deviation * static_cast<double>(number));
        count = noisy < 0 ? 0 : noisy;
    });
}

}} // namespace tactnet
