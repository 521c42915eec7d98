#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

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
