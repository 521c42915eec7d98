#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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

/// Changes readings under load linearly with time, by the factor 1 + rate · t at the time t since the start
/// of the touch (moment.seconds), clamped at zero. The rate is normally distributed over sensors.
struct drift {
    static constexpr stage place = stage::film;
    static constexpr effect_purpose purpose{3};

    /// Standard deviation of the rate over sensors, per second; 0 or less is none. Chosen: 5 % per hour.
    double deviation = 0.05 / 3600;

    template <shape Shape>
    class bound {
    public:
        bound(const drift& effect, const mounting& where) {
            if (!(effect.deviation > 0))
                return;
            alignas(vector_alignment) std::array<float, kernels::normal_numbers::chunk_size> numbers;
            kernels::normal_numbers(where.unit.random(purpose)).chunk(0, numbers.data());
            rate_ = effect.deviation * static_cast<double>(numbers[0]);
        }
        void apply(signal<Shape> pressures, const moment& now) const noexcept {
            if (now.seconds > 0)
                scale<Shape>(pressures, 1 + rate_ * now.seconds);
        }
        /// The rate of this sensor, per second.
        [[nodiscard]] double rate() const { return rate_; }

    private:
        double rate_ = 0;
    };
};

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
