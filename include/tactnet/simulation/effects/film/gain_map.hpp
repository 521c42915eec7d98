#pragma once

#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// A gain per tactel, which is a property of the sensor. Gains are independent and log-normal with mean one,
/// as in the 1100 images of the paper's sensor: a fixed pattern (correlation of 0.95 between two halves of
/// the images) with a relative standard deviation of 0.30, skewed (percentiles 1, 25, 50, 75 and 99 of gain −
/// 1 at −0.59, −0.23, −0.07, 0.13 and 0.81), and almost no correlation of neighbours.
struct gain_map {
    static constexpr stage place = stage::film;
    static constexpr effect_purpose purpose{0};

    double deviation = 0.30; ///< relative standard deviation; 0 or less is none

    template <shape Shape>
    class bound {
    public:
        bound(const gain_map& effect, const mounting& where) {
            gains_.fill(1);
            if (!(effect.deviation > 0))
                return;
            // The variance of the logarithm for which the gain has this deviation and mean one.
            const double variance = std::log1p(std::min(effect.deviation * effect.deviation, max_variance));
            kernels::normal_numbers(where.unit.random(purpose))
                .each(Shape.size(), [&](std::size_t tactel, float number) {
                    gains_[tactel] = static_cast<float>(
                        std::exp(std::sqrt(variance) * static_cast<double>(number) - variance / 2));
                });
        }
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i)
                pressures.data()[i] *= gains_[i];
        }
        /// The gain of each tactel.
        [[nodiscard]] tensor_view<const float, Shape> gains() const& { return gains_; }
        void gains() const&& = delete; // would dangle

    private:
        static constexpr double max_variance = 1e6; // keeps every gain finite

        std::array<float, Shape.size()> gains_;
    };
};

}}} // namespace tactnet::simulation
