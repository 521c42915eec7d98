#pragma once

#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/simulation/effect.hpp>

#include <array>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// The reading of a sensor that stays loaded changes evenly with time, at a rate that differs from one sensor
/// to the next: 1 + rate · t times as much at the time t since the touch began (moment.seconds), with a rate
/// that is normal over the sensors' numbers. Never below zero.
struct drift {
    static constexpr stage place = stage::film;
    static constexpr effect_purpose purpose{3};

    /// Share per second, the standard deviation over sensors; 0 or less is none. Chosen: 5 % an hour.
    double deviation = 0.05 / 3600;

    template <shape Shape>
    class bound {
    public:
        bound(const drift& effect, const mounting& where) {
            if (!(effect.deviation > 0))
                return;
            alignas(64) std::array<float, kernels::normal_numbers::chunk_size> numbers;
            kernels::normal_numbers(where.unit.random(purpose)).chunk(0, numbers.data());
            rate_ = effect.deviation * static_cast<double>(numbers[0]);
        }
        void apply(signal<Shape> pressures, const moment& now) const noexcept {
            if (now.seconds > 0)
                scale<Shape>(pressures, 1 + rate_ * now.seconds);
        }
        /// Of this sensor: share per second.
        [[nodiscard]] double rate() const { return rate_; }

    private:
        double rate_ = 0;
    };
};

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
