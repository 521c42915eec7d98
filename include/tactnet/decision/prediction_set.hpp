#pragma once

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
    /// Returns how many are: 0 if a logit is not finite.
    std::size_t predict(std::span<const float> logits, std::span<bool> members) const noexcept {
        std::fill(members.begin(), members.end(), false);
        logits = logits.first(members.size());
        for (const float logit : logits)
            if (!(std::abs(logit) <= std::numeric_limits<float>::max()))
                return 0;
        const std::size_t most = first_largest(logits);
        const auto logarithm = [&](std::size_t c) { // of its probability ÷ that of the most likely one
            return (static_cast<double>(logits[c]) - static_cast<double>(logits[most])) /
                   scaling_.temperature;
        };
        double sum = 0;
        for (std::size_t c = 0; c < members.size(); ++c)
            sum += std::exp(logarithm(c));
        const double least = least_ > 0 ? std::log(least_ * sum) : -std::numeric_limits<double>::infinity();
        std::size_t count = 0;
        for (std::size_t c = 0; c < members.size(); ++c) {
            members[c] = c == most || logarithm(c) >= least;
            count += members[c];
        }
        return count;
    }

private:
    temperature_scaling scaling_;
    double least_;
};

}} // namespace tactnet
