#pragma once

#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// The granularity of a resistive film, which conducts through many tiny contacts between rough sides. Their
/// number grows with the pressure, and varies by its square root: the standard deviation of the reading of a
/// pressure p is texture × √p. One part is a property of the sensor, the other varies from touch to touch.
/// The defaults are fitted to the paper's images (for counts from 18 to 190, 1.75 √count fixed and 2.0 √count
/// varying).
struct film_texture {
    static constexpr stage place = stage::film;
    static constexpr effect_purpose purpose{7};

    double fixed = 20.2;   ///< √Pa, per sensor
    double varying = 23.1; ///< √Pa, per touch

    template <shape Shape>
    class bound {
    public:
        bound(const film_texture& effect, const mounting& where)
            : varying_(static_cast<float>(effect.varying)) {
            const auto deviation = static_cast<float>(effect.fixed);
            kernels::normal_numbers(where.unit.random(purpose))
                .each(Shape.size(),
                      [&](std::size_t i, float normal) { fixed_.data()[i] = deviation * normal; });
        }
        void apply(signal<Shape> pressures, const moment& now) const noexcept {
            kernels::normal_numbers(now.random(purpose)).each(Shape.size(), [&](std::size_t i, float normal) {
                float& pressure = pressures.data()[i];
                const float texture = fixed_.data()[i] + varying_ * normal;
                const float textured = pressure + texture * std::sqrt(pressure > 0 ? pressure : 0);
                pressure = textured < 0 ? 0 : textured; // NaN stays
            });
        }

    private:
        float varying_;
        tensor<float, Shape> fixed_;
    };
};

}}} // namespace tactnet::simulation
