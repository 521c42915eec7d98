#pragma once

#include <tactnet/simulation/effect.hpp>

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

}}} // namespace tactnet::simulation
