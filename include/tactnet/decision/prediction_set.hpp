#pragma once

#include <tactnet/decision/exponentials.hpp>
#include <tactnet/decision/temperature_scaling.hpp>
#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

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
