#pragma once

#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

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

}} // namespace tactnet
