#pragma once

#include <tactnet/simulation/effect.hpp>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Scales readings with temperature, by the factor 1 + sensitivity · (T − calibrated) at T = moment.celsius,
/// clamped at zero.
struct temperature {
    static constexpr stage place = stage::film;

    /// Increase per kelvin; 0 is none. The maker of the paper's sensor states it for single sensors of the
    /// same kind (FlexiForce A201, data sheet).
    double sensitivity = 0.0036;
    double calibrated = 22; ///< degrees Celsius at which readings are exact

    template <shape Shape>
    class bound {
    public:
        bound(const temperature& effect, const mounting&)
            : sensitivity_(effect.sensitivity), calibrated_(effect.calibrated) {}
        void apply(signal<Shape> pressures, const moment& now) const noexcept {
            scale<Shape>(pressures, 1 + sensitivity_ * (now.celsius - calibrated_));
        }

    private:
        double sensitivity_, calibrated_;
    };
};

}}} // namespace tactnet::simulation
