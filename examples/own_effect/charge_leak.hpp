#pragma once

// An effect of your own: a piezoelectric film gives charge only while the pressure changes, and the charge
// leaks away. Copy it, and change the parameters, the stage and `apply`.

#include <tactnet/simulation/effect.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

/// What is left of a constant pressure falls by e in each `time_constant`.
struct charge_leak {
    static constexpr tactnet::simulation::stage place = tactnet::simulation::stage::film;

    double time_constant = 1.0; ///< seconds; 0 or less, and NaN, is none

    template <tactnet::shape Shape>
    class bound {
    public:
        bound(const charge_leak& effect, const tactnet::simulation::mounting&)
            : time_constant_(effect.time_constant > 0 ? effect.time_constant
                                                      : std::numeric_limits<double>::infinity()) {}

        /// Pascals in, pascals out: the reading that is left, and what has come since the frame before.
        void apply(tactnet::simulation::signal<Shape> pressures,
                   const tactnet::simulation::moment& now) noexcept {
            const auto kept =
                static_cast<float>(std::exp(-std::max(now.seconds - seconds_, 0.0) / time_constant_));
            seconds_ = now.seconds;
            for (std::size_t i = 0; i < Shape.size(); ++i) {
                const float pressure = pressures.data()[i];
                reading_.data()[i] = kept * reading_.data()[i] + (pressure - before_.data()[i]);
                before_.data()[i] = pressure;
                pressures.data()[i] = reading_.data()[i];
            }
        }
        /// A new touch: nothing is remembered.
        void reset() noexcept {
            seconds_ = 0;
            std::fill(before_.begin(), before_.end(), 0.0f);
            std::fill(reading_.begin(), reading_.end(), 0.0f);
        }

    private:
        double time_constant_, seconds_ = 0;
        tactnet::tensor<float, Shape> before_{}, reading_{};
    };
};
