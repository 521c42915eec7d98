#pragma once

#include <tactnet/detail/arithmetic.hpp>
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
