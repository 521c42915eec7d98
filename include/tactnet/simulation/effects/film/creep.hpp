#pragma once

#include <tactnet/simulation/effect.hpp>

#include <cmath>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Increases readings under a constant load, by the factor 1 + rate · log₁₀(1 + t / time) at the time t since
/// the start of the touch (moment.seconds).
struct creep {
    static constexpr stage place = stage::film;

    /// Increase per decade of time. The maker of the paper's sensor states at most 5 % per decade for single
    /// sensors of the same kind (FlexiForce A201, data sheet).
    double rate = 0.05;
    double time = 1; ///< seconds, the start of the first decade; chosen. 0 or less: no creep

    template <shape Shape>
    class bound {
    public:
        bound(const creep& effect, const mounting&) : rate_(effect.rate), time_(effect.time) {}
        void apply(signal<Shape> pressures, const moment& now) const noexcept {
            if (now.seconds > 0 && time_ > 0)
                scale<Shape>(pressures, 1 + rate_ * std::log10(1 + now.seconds / time_));
        }

    private:
        double rate_, time_;
    };
};

}}} // namespace tactnet::simulation
