#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

// Counts of any depth, as sensors give them, and the one scale of counts that networks, health and contact
// have: 0 without a touch, 255 at full scale.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The scale of a sensor's counts. For a 12-bit sensor: {.full = 4095}; for one whose counts fall from 2135
/// to 0:
/// {.untouched = 2135, .full = 0}.
struct count_scale {
    float untouched = 0; ///< the count without a touch
    float full = 255;    ///< the count at full scale, which becomes 255; another than `untouched`
    /// The count that marks a broken tactel. NaN and infinity always do.
    float broken = std::numeric_limits<float>::quiet_NaN();

    /// A count on the scale of 8 bits, from 0 on: 0 for less than no touch, above 255 beyond full scale; NaN
    /// of a broken tactel. Without a scale, `full` as `untouched`, it is 0.
    [[nodiscard]] float of(float count) const noexcept {
        if (!std::isfinite(count) || count == broken)
            return std::numeric_limits<float>::quiet_NaN();
        const float scaled = full == untouched ? 0 : (count - untouched) * (255 / (full - untouched));
        return scaled > 0 ? scaled : 0.0f;
    }
};

/// A frame of a sensor that someone else owns: std::uint8_t, std::uint16_t or float, row by row. Converts
/// from std::array, from a std::span of fixed size and from what converts to one.
template <shape Array>
class raw_counts {
    template <class Count>
    using frame = std::span<const Count, Array.size()>;

public:
    template <class Frame>
        requires(std::convertible_to<const Frame&, frame<std::uint8_t>> ||
                 std::convertible_to<const Frame&, frame<std::uint16_t>> ||
                 std::convertible_to<const Frame&, frame<float>>)
    raw_counts(const Frame& counts) noexcept : bytes_(sizeof(*std::begin(counts))) {
        if constexpr (std::convertible_to<const Frame&, frame<std::uint8_t>>)
            counts_ = frame<std::uint8_t>(counts).data();
        else if constexpr (std::convertible_to<const Frame&, frame<std::uint16_t>>)
            counts_ = frame<std::uint16_t>(counts).data();
        else
            counts_ = frame<float>(counts).data();
    }

    /// Writes the counts in 1/256 of an 8-bit count, up to 65535, and for each whether it marks a broken
    /// tactel: 1 or 0. Returns whether any does.
    bool quantise(const count_scale& scale, std::uint16_t* to, std::uint16_t* broken) const noexcept {
        switch (bytes_) {
        case 1:
            return kernels::quantise<Array.size()>(static_cast<const std::uint8_t*>(counts_), factor(scale),
                                                   scale.untouched, scale.broken, to, broken);
        case 2:
            return kernels::quantise<Array.size()>(static_cast<const std::uint16_t*>(counts_), factor(scale),
                                                   scale.untouched, scale.broken, to, broken);
        default:
            return kernels::quantise<Array.size()>(static_cast<const float*>(counts_), factor(scale),
                                                   scale.untouched, scale.broken, to, broken);
        }
    }

private:
    static float factor(const count_scale& scale) noexcept {
        return scale.full == scale.untouched ? 0 : 255 * 256 / (scale.full - scale.untouched);
    }

    const void* counts_ = nullptr;
    std::size_t bytes_; ///< of a count
};

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
