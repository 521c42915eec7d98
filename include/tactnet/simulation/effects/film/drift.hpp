#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/simulation/effect.hpp>

#include <array>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

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

}}} // namespace tactnet::simulation
