#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Lowers readings while pressure rises and raises them while it falls: a sum of play operators (the
/// Prandtl-Ishlinskii model; Krasnosel'skii, Pokrovskii, Systems with Hysteresis, 1989):
///
///     play ← max(p − threshold, min(p + threshold, play)),  reading = p + Σ weight · (play − p).
///
/// While rising from rest, the reading lags by Σ weight · threshold; while falling, it leads by as much.
/// After a touch a residue remains until the scene is reset.
struct hysteresis {
    static constexpr stage place = stage::film;

    /// A play operator.
    struct play {
        double threshold; ///< pascals; at least zero is used
        double weight;    ///< fraction of the reading, 0 … 1; at least zero is used
    };
    static constexpr double step = tekscan_6077::saturation_pressure / 16;
    /// By default the loop of a full cycle is 4.5 % of full scale wide at its middle, the maximum that the
    /// maker of the paper's sensor states for single sensors of the same kind (FlexiForce A201, data sheet).
    /// Equal weights and spacing are chosen.
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
                    // In this order, the state never becomes NaN.
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

}}} // namespace tactnet::simulation
