#pragma once

#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// A nonlinear response: x = p / full_scale becomes x · (1 + b) / (1 + b · x), which is exact at zero and at
/// full scale, and too high, as films saturate, or too low between. Above full scale it is linear.
struct linearity {
    static constexpr stage place = stage::film;

    /// Largest deviation from linear, as a fraction of full scale, −0.9 … 0.9; 0 is none. The maker of the
    /// paper's sensor states ±3 % for single sensors of the same kind (FlexiForce A201, data sheet).
    double error = 0.03;
    double full_scale = tekscan_6077::saturation_pressure; ///< pascals, above zero

    template <shape Shape>
    class bound {
    public:
        bound(const linearity& effect, const mounting&) {
            // The deviation is largest at x = 1 / (1 + √(1 + b)): (√(1 + b) − 1) / (√(1 + b) + 1).
            const double kept = effect.error == effect.error ? std::clamp(effect.error, -0.9, 0.9) : 0;
            const double root = (1 + kept) / (1 - kept);
            if (!(effect.full_scale > 0))
                return;
            bend_ = static_cast<float>(root * root - 1);
            inverse_scale_ = static_cast<float>(1 / effect.full_scale);
        }
        void apply(signal<Shape> pressures, const moment&) const noexcept {
            for (std::size_t i = 0; i < Shape.size(); ++i) {
                const float pressure = pressures.data()[i], share = pressure * inverse_scale_;
                const float inside = share > 0 ? (share < 1 ? share : 1) : 0;
                pressures.data()[i] = pressure * ((1 + bend_) / (1 + bend_ * inside));
            }
        }

    private:
        float bend_ = 0, inverse_scale_ = 0;
    };
};

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

/// Scales readings with temperature, by the factor 1 + sensitivity · (T − calibrated) at T = moment.celsius,
/// clamped at zero.
struct temperature {
    static constexpr stage place = stage::film;

    /// Increase per kelvin; 0 is none. The maker of the paper's sensor states it for single sensors of the
    /// same kind (FlexiForce A201, data sheet).
    double sensitivity = 0.0036;
    double calibrated = 22; ///< degrees Celsius at which readings are exact

    template <shape Shape>
    class bound {
    public:
        bound(const temperature& effect, const mounting&)
            : sensitivity_(effect.sensitivity), calibrated_(effect.calibrated) {}
        void apply(signal<Shape> pressures, const moment& now) const noexcept {
            scale<Shape>(pressures, 1 + sensitivity_ * (now.celsius - calibrated_));
        }

    private:
        double sensitivity_, calibrated_;
    };
};

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
