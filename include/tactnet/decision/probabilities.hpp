#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/config.hpp>
#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The largest of some values, and whether all are finite. −infinity of none.
template <class T>
struct value_range {
    T largest = -std::numeric_limits<T>::infinity();
    bool finite = true;

    explicit value_range(std::span<const T> values) noexcept {
        for (const T value : values) {
            finite &= std::abs(value) <= std::numeric_limits<T>::max();
            largest = value > largest ? value : largest;
        }
    }
};

/// The sum of e^((value − largest) · scale), for values of which none is larger. Powers are in single
/// precision, with an error of at most 2⁻¹⁷ of themselves, 2⁻²² from e⁻² on; those below e⁻⁸⁷ count as 0.
template <class T>
[[nodiscard]] double sum_of_exponentials(std::span<const T> values, T largest, double scale) noexcept {
    constexpr std::size_t block = 64, ways = 4; // sums of their own, which need not wait for one another
    static_assert(block % kernels::lanes<float> == 0);
    alignas(vector_alignment) std::array<float, block> powers;
    std::array<double, ways> sums{};
    for (std::size_t first = 0; first < values.size(); first += block) {
        const std::size_t count = std::min(block, values.size() - first);
        for (std::size_t i = 0; i < count; ++i)
            powers[i] = static_cast<float>(
                (static_cast<double>(values[first + i]) - static_cast<double>(largest)) * scale);
        const std::size_t padded =
            ceil_div(count, std::max(kernels::lanes<float>, ways)) * std::max(kernels::lanes<float>, ways);
        std::fill(powers.begin() + static_cast<std::ptrdiff_t>(count),
                  powers.begin() + static_cast<std::ptrdiff_t>(padded),
                  -std::numeric_limits<float>::infinity());
        for (std::size_t i = 0; i < padded; i += kernels::lanes<float>)
            kernels::store(powers.data() + i, kernels::exponential(kernels::load(powers.data() + i)));
        for (std::size_t i = 0; i < padded; i += ways)
            for (std::size_t way = 0; way < ways; ++way)
                sums[way] += static_cast<double>(powers[i + way]);
    }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

}}} // namespace tactnet::detail

namespace tactnet { inline namespace TACTNET_ARCH {

/// A softmax of logits divided by a temperature. Below 1, probabilities are more extreme; the class stays the
/// same.
struct temperature_scaling {
    double temperature = 1; ///< from 0.001 to 1000; with any other there is no answer (is_temperature)

    /// The most likely of the first `classes` outputs, as classify_logits returns it.
    [[nodiscard]] std::optional<recognition> classify(std::span<const float> logits,
                                                      std::size_t classes) const noexcept {
        return classify_logits(logits, classes, temperature);
    }
    /// Writes the logarithm of the probability of each class; nothing unless all logits are finite and the
    /// temperature is one. Returns whether they are.
    [[nodiscard]] bool log_probabilities(std::span<const float> logits, std::span<double> to) const noexcept {
        if (!is_temperature(temperature))
            return false;
        double largest = -std::numeric_limits<double>::infinity(), sum = 0;
        for (const float logit : logits.first(to.size())) {
            if (!(std::abs(logit) <= std::numeric_limits<float>::max()))
                return false;
            largest = std::max(largest, static_cast<double>(logit));
        }
        for (const float logit : logits.first(to.size()))
            sum += std::exp((static_cast<double>(logit) - largest) / temperature);
        const double log_sum = std::log(sum);
        for (std::size_t c = 0; c < to.size(); ++c)
            to[c] = (static_cast<double>(logits[c]) - largest) / temperature - log_sum;
        return true;
    }
};

/// Sets of classes that hold the right one as often as promised (split conformal prediction: Vovk et al.,
/// 2005): one class where the network is sure, several where it is not.
class prediction_set {
public:
    /// The classes with at least this probability, and the most likely one.
    explicit prediction_set(const temperature_scaling& scaling, double least_probability) noexcept
        : scaling_(scaling), least_(least_probability) {}

    [[nodiscard]] double least_probability() const noexcept { return least_; }

    /// Writes whether each class is in the set for a frame, with as many `members` as there are classes.
    /// Returns how many are: 0 if a logit is not finite, or the temperature is none (is_temperature).
    std::size_t predict(std::span<const float> logits, std::span<bool> members) const noexcept {
        std::fill(members.begin(), members.end(), false);
        logits = logits.first(members.size());
        const detail::value_range range(logits);
        if (!range.finite || logits.empty() || !is_temperature(scaling_.temperature))
            return 0;
        const auto largest = static_cast<double>(range.largest);
        // Probabilities are compared by their logarithms.
        const double sum = detail::sum_of_exponentials(logits, range.largest, 1 / scaling_.temperature),
                     least = least_ > 0 ? largest + scaling_.temperature * std::log(least_ * sum)
                                        : -std::numeric_limits<double>::infinity();
        std::size_t count = 0;
        for (std::size_t c = 0; c < members.size(); ++c) {
            members[c] = static_cast<double>(logits[c]) >= least;
            count += members[c];
        }
        if (count == 0) {
            members[first_largest(logits)] = true;
            count = 1;
        }
        return count;
    }

private:
    temperature_scaling scaling_;
    double least_;
};

}} // namespace tactnet

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
