#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// Reads less while pressure grows than while it falls: a sum of play operators (the model of Prandtl and
/// Ishlinskii; Krasnosel'skii, Pokrovskii, Systems with Hysteresis, 1989). Each follows the pressure as a pin
/// does in a slot of the half-width `threshold`:
///
///     play ← max(p − threshold, min(p + threshold, play)),  reading = p + Σ weight · (play − p).
///
/// On the way up from rest the reading lags by Σ weight · threshold, on the way down it leads by as much.
/// After a touch something remains. Has a memory: a scene's reset() is the sensor at rest.
struct hysteresis {
    static constexpr stage place = stage::film;

    struct play {
        double threshold; ///< pascals; below zero counts as zero
        double weight;    ///< share of the reading, 0 … 1; 0 or less is none
    };
    static constexpr double step = tekscan_6077::saturation_pressure / 16;
    /// By default the loop of a full cycle is 4.5 % of full scale wide at its middle, which the maker of the
    /// paper's sensor states as the most for single sensors of the same kind (FlexiForce A201, data sheet).
    /// That the four have the same weight at even distances is chosen.
    std::array<play, 4> plays{{{step, 0.036}, {2 * step, 0.036}, {3 * step, 0.036}, {4 * step, 0.036}}};

    template <shape Shape>
    class bound {
    public:
        bound(const hysteresis& effect, const mounting&) {
            for (std::size_t k = 0; k < thresholds_.size(); ++k) {
                thresholds_[k] = static_cast<float>(std::max(0.0, effect.plays[k].threshold));
                weights_[k] = static_cast<float>(std::max(0.0, effect.plays[k].weight));
            }
            reset();
        }
        void apply(signal<Shape> pressures, const moment&) noexcept {
            if (std::all_of(weights_.begin(), weights_.end(), [](float weight) { return weight == 0; }))
                return;
            for (std::size_t i = 0; i < Shape.size(); ++i) {
                const float pressure = pressures.data()[i];
                float reading = pressure;
                for (std::size_t k = 0; k < states_.size(); ++k) {
                    // In this order NaN is forgotten, not remembered.
                    float& play = states_[k][i];
                    const float highest = pressure + thresholds_[k], lowest = pressure - thresholds_[k];
                    play = highest < play ? highest : play;
                    play = lowest > play ? lowest : play;
                    reading += weights_[k] * (play - pressure);
                }
                pressures.data()[i] = reading;
            }
        }
        void reset() noexcept {
            for (auto& states : states_)
                states.fill(0);
        }

    private:
        static constexpr std::size_t count = 4;

        std::array<float, count> thresholds_, weights_;
        std::array<std::array<float, Shape.size()>, count> states_;
    };
};

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
