#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Sets pressures below the threshold to zero, as the electronics of tactile arrays do to suppress noise: the
/// paper's images are exactly zero away from the object.
struct threshold {
    static constexpr stage place = stage::circuit;

    /// Pascals; 0 or less is none. Chosen: two counts of the paper's converter, four deviations of the noise.
    double level = 267;

    template <shape Shape>
    class bound {
    public:
        bound(const threshold& effect, const mounting&)
            : level_(effect.level > 0 ? static_cast<float>(effect.level)
                                      : -std::numeric_limits<float>::infinity()) {}
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i)
                pressures.data()[i] = pressures.data()[i] < level_ ? 0 : pressures.data()[i];
        }

    private:
        float level_;
    };
};

/// Clamps pressures at the limit of the circuit, by default that of the paper's sensor.
struct saturation {
    static constexpr stage place = stage::circuit;

    double limit = tekscan_6077::saturation_pressure; ///< pascals; infinite for none

    template <shape Shape>
    class bound {
    public:
        bound(const saturation& effect, const mounting&) : limit_(static_cast<float>(effect.limit)) {}
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i)
                pressures.data()[i] = std::min(pressures.data()[i], limit_);
        }

    private:
        float limit_;
    };
};

/// The converter: pressures are rounded to counts and clamped to 0 … Levels − 1.
template <std::size_t Levels>
struct quantisation_levels {
    static_assert(Levels >= 2 && Levels <= 65536,
                  "quantisation: there must be 2 to 65536 levels, 1 to 16 bits");
    static constexpr stage place = stage::converter;

    double full_scale = tekscan_6077::saturation_pressure; ///< pascals at the last count

    template <shape Shape>
    class bound {
    public:
        bound(const quantisation_levels& effect, const mounting&)
            : scale_(static_cast<float>((Levels - 1) / effect.full_scale)) {}
        void apply(signal<Shape> values, const moment&) const noexcept {
            constexpr auto last = static_cast<float>(Levels - 1);
            for (std::size_t i = 0; i < Shape.size(); ++i) {
                const float scaled = values.data()[i] * scale_;
                const float kept = std::min(last, std::max(0.0f, scaled)); // NaN is 0
                values.data()[i] = std::floor(kept + 0.5f);
            }
        }

    private:
        float scale_;
    };
};

/// A converter of 1 to 16 bits, as quantisation<8>.
template <std::size_t Bits>
using quantisation = quantisation_levels<(std::size_t{1} << std::min(Bits, std::size_t{17}))>;

}}} // namespace tactnet::simulation
