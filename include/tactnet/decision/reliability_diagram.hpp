#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// How well the probabilities of recognised classes agree with how often they are right: a reliability
/// diagram, the expected calibration error (Naeini et al., 2015) and the Brier score of
/// the recognised class.
class reliability_diagram {
public:
    static constexpr std::size_t bin_count = 15; ///< of equal width, from probability 0 to 1

    /// The recognitions whose probability lies within one bin.
    struct bin {
        std::size_t count = 0, right = 0;
        double probability = 0; ///< sum
        double squares = 0;     ///< sum of (probability − 1)² of right, probability² of wrong ones

        [[nodiscard]] double mean_probability() const noexcept {
            return count > 0 ? probability / static_cast<double>(count) : 0;
        }
        [[nodiscard]] double accuracy() const noexcept {
            return count > 0 ? static_cast<double>(right) / static_cast<double>(count) : 0;
        }
    };

    reliability_diagram() = default;
    /// As it was kept.
    explicit reliability_diagram(const std::array<bin, bin_count>& bins) noexcept : bins_(bins) {}

    /// Takes the probability of a recognised class, from 0 to 1, and whether it is right. Ignores NaN.
    void add(double probability, bool right) noexcept {
        if (std::isnan(probability))
            return;
        const double clamped = std::clamp(probability, 0.0, 1.0);
        bin& of = bins_[std::min(static_cast<std::size_t>(clamped * bin_count), bin_count - 1)];
        ++of.count;
        of.right += right;
        of.probability += clamped;
        const double difference = clamped - (right ? 1 : 0);
        of.squares += difference * difference;
    }
    /// Takes all that another one has taken.
    void add(const reliability_diagram& other) noexcept {
        for (std::size_t b = 0; b < bin_count; ++b) {
            bins_[b].count += other.bins_[b].count;
            bins_[b].right += other.bins_[b].right;
            bins_[b].probability += other.bins_[b].probability;
            bins_[b].squares += other.bins_[b].squares;
        }
    }

    [[nodiscard]] const std::array<bin, bin_count>& bins() const noexcept { return bins_; }
    /// The mean distance of a bin's accuracy from its mean probability, weighted by counts; 0 without any.
    /// Few frames scatter: 220 perfectly calibrated ones give about 0.03.
    [[nodiscard]] double calibration_error() const noexcept {
        return mean_over_all(
            [](const bin& of) { return std::abs(of.probability - static_cast<double>(of.right)); });
    }
    /// The mean square of probability − 1 for right, of probability for wrong ones; 0 without any.
    [[nodiscard]] double brier_score() const noexcept {
        return mean_over_all([](const bin& of) { return of.squares; });
    }

private:
    template <class SumOfBin>
    [[nodiscard]] double mean_over_all(const SumOfBin& sum_of) const noexcept {
        double sum = 0;
        std::size_t count = 0;
        for (const bin& each : bins_)
            sum += sum_of(each), count += each.count;
        return count > 0 ? sum / static_cast<double>(count) : 0;
    }

    std::array<bin, bin_count> bins_{};
};

}} // namespace tactnet
