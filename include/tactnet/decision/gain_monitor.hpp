#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The mean and deviation of the natural logarithm of the force of touches.
struct force_statistics {
    double mean = 0, deviation = 0;

    /// Computes them from the images that a network was trained on, `size` counts each. As in contact_state,
    /// the force of an image is the sum of its counts from `pressed` on (see contact_detector::pressed).
    /// Images without such counts are left out; fewer than two others give {0, 0}, statistics of nothing, by
    /// which gain_monitor estimates nothing.
    [[nodiscard]] static force_statistics of(std::span<const std::uint8_t> images, std::size_t size,
                                             std::uint8_t pressed) noexcept {
        double mean = 0, squares = 0, count = 0;
        for (std::size_t first = 0; size > 0 && first + size <= images.size(); first += size) {
            double force = 0;
            for (const std::uint8_t pressure : images.subspan(first, size))
                force += pressure >= pressed ? pressure : 0;
            if (force == 0)
                continue;
            const double value = std::log(force), difference = value - mean;
            mean += difference / ++count;
            squares += difference * (value - mean);
        }
        return count > 1 ? force_statistics{mean, std::sqrt(squares / (count - 1))} : force_statistics{};
    }
};

/// Estimates the gain of a sensor, compared with the gain that a network was trained at, from the forces of
/// many touches: objects differ in force, but their average does not, as long as the robot touches a mixture
/// of objects like that of the training. A robot that touches one object all day must not compensate a gain.
class gain_monitor {
public:
    /// `memory` is the number of touches over which the estimate forgets, from 1; an infinite one forgets
    /// nothing. `gain_deviation` is the deviation of the logarithm of gains that are expected, from 10⁻⁶ to
    /// 10³: the estimate shrinks towards 1 by it while few touches are known. Both are clamped; NaN counts as
    /// the smallest. With statistics of nothing, or that no forces have, the gain remains 1.
    explicit gain_monitor(const force_statistics& trained, double memory = 50,
                          double gain_deviation = 0.3) noexcept
        : trained_(trained),
          memory_(memory > 1 ? memory : 1.0),
          gain_deviation_(gain_deviation > 1e-6 ? std::min(gain_deviation, 1e3) : 1e-6) {}

    /// Takes the force of a touch, of its strongest frame (contact_state::force). Ignores what is no positive
    /// finite number.
    void add_touch(double force) noexcept {
        if (!(force > 0) || std::isinf(force) || !is_of_forces(trained_))
            return;
        const double keep = 1 - 1 / memory_;
        weight_ = weight_ * keep + 1;
        squared_weight_ = squared_weight_ * keep * keep + 1;
        sum_ = sum_ * keep + (std::log(force) - trained_.mean);
    }
    /// The gain: 1 as in the training, 0.5 for half the counts.
    [[nodiscard]] double gain() const noexcept {
        const double ratio = trained_.deviation / gain_deviation_;
        return weight_ > 0 ? std::exp(std::clamp(sum_ / (weight_ + ratio * ratio), -700.0, 700.0)) : 1.0;
    }
    /// The deviation of the estimate's logarithm, of the scatter of forces alone.
    [[nodiscard]] double uncertainty() const noexcept {
        return weight_ > 0 ? trained_.deviation * std::sqrt(squared_weight_) / weight_ : gain_deviation_;
    }
    /// Whether the gain differs from 1 by more than three deviations.
    [[nodiscard]] bool drifted() const noexcept {
        return weight_ > 0 && std::abs(sum_ / weight_) > 3 * uncertainty();
    }

private:
    /// Logarithms of numbers of 64 bits are within 745 of zero.
    [[nodiscard]] static bool is_of_forces(const force_statistics& trained) noexcept {
        return std::abs(trained.mean) <= 745 && trained.deviation >= 0 && trained.deviation <= 1500 &&
               (trained.mean != 0 || trained.deviation != 0);
    }

    force_statistics trained_;
    double memory_, gain_deviation_, weight_ = 0, squared_weight_ = 0, sum_ = 0;
};

}} // namespace tactnet
