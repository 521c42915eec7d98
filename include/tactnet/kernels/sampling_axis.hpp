#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

// Where the pixels of a resampled map come from, along one axis, with the positions of PyTorch's nn.Upsample
// (align_corners=False).

namespace tactnet { inline namespace TACTNET_ARCH {

/// How pixels are made of those of another map: the pixel that they fall on, or a weighted mean of the two
/// nearest along each axis. Neither is antialiased.
enum class interpolation { nearest, bilinear };

namespace kernels {

/// The inputs of all outputs along one axis, for a map of `From` and a map of `To` pixels, both at least 1.
template <interpolation Mode, std::size_t From, std::size_t To>
struct sampling_axis {
    static constexpr std::size_t inputs = From, outputs = To;
    /// Inputs per output.
    static constexpr std::size_t taps = Mode == interpolation::bilinear && From > 1 ? 2 : 1;

private:
    static constexpr std::size_t common = std::gcd(From, To);

    /// The coordinate of an output, in parts of a pixel. PyTorch finds the nearest pixel in single precision,
    /// whose rounding decides about some sizes.
    static constexpr std::size_t position(std::size_t output) {
        if constexpr (Mode == interpolation::nearest) {
            const float scale = static_cast<float>(From) / static_cast<float>(To);
            return std::min(static_cast<std::size_t>(static_cast<float>(output) * scale), From - 1);
        } else {
            // (output + ½) · From ÷ To − ½, but not before the first pixel.
            const std::size_t end = (2 * output + 1) * (From / common), half = To / common;
            return end > half ? end - half : 0;
        }
    }

public:
    /// The sum of the parts of an output.
    static constexpr std::size_t denominator = Mode == interpolation::bilinear ? 2 * (To / common) : 1;

    /// Inputs first … first + taps − 1, their parts, and their weights: parts ÷ denominator.
    struct output {
        std::size_t first = 0;
        std::array<std::int32_t, taps> parts{};
        std::array<double, taps> weights{};
    };
    static constexpr std::array<output, To> table = [] {
        std::array<output, To> all{};
        for (std::size_t o = 0; o < To; ++o) {
            const std::size_t place = position(o), pixel = std::min(place / denominator, From - 1),
                              after = pixel + 1 < From ? place % denominator : 0;
            output& here = all[o];
            here.first = std::min(pixel, From - taps);
            here.parts[pixel - here.first] = static_cast<std::int32_t>(denominator - after);
            if (after > 0)
                here.parts[taps - 1] = static_cast<std::int32_t>(after);
            for (std::size_t t = 0; t < taps; ++t)
                here.weights[t] = static_cast<double>(here.parts[t]) / static_cast<double>(denominator);
        }
        return all;
    }();
};

} // namespace kernels
}} // namespace tactnet
