#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

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

}}} // namespace tactnet::simulation
