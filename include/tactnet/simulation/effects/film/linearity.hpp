#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// A nonlinear response: x = p / full_scale becomes x · (1 + b) / (1 + b · x), which is exact at zero and at
/// full scale, and too high, as films saturate, or too low between. Above full scale it is linear.
struct linearity {
    static constexpr stage place = stage::film;

    /// Largest deviation from linear, as a fraction of full scale, −0.9 … 0.9; 0 is none. The maker of the
    /// paper's sensor states ±3 % for single sensors of the same kind (FlexiForce A201, data sheet).
    double error = 0.03;
    double full_scale = tekscan_6077::saturation_pressure; ///< pascals, above zero

    template <shape Shape>
    class bound {
    public:
        bound(const linearity& effect, const mounting&) {
            // The deviation is largest at x = 1 / (1 + √(1 + b)): (√(1 + b) − 1) / (√(1 + b) + 1).
            const double kept = effect.error == effect.error ? std::clamp(effect.error, -0.9, 0.9) : 0;
            const double root = (1 + kept) / (1 - kept);
            if (!(effect.full_scale > 0))
                return;
            bend_ = static_cast<float>(root * root - 1);
            inverse_scale_ = static_cast<float>(1 / effect.full_scale);
        }
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i) {
                const float pressure = pressures.data()[i], share = pressure * inverse_scale_;
                const float inside = share > 0 ? (share < 1 ? share : 1) : 0;
                pressures.data()[i] = pressure * ((1 + bend_) / (1 + bend_ * inside));
            }
        }

    private:
        float bend_ = 0, inverse_scale_ = 0;
    };
};

}}} // namespace tactnet::simulation
