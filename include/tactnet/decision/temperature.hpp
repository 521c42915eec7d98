#pragma once

#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

// From logits to probabilities that are what they say: among frames recognised with a probability of 0.9,
// nine of ten are right (Guo et al., "On calibration of modern neural networks", 2017).

namespace tactnet { inline namespace TACTNET_ARCH {

/// A softmax of logits divided by a temperature. Below 1, probabilities are more extreme; the class stays the
/// same.
struct temperature_scaling {
    double temperature = 1;

    /// The most likely of the first `classes` outputs, as classify_logits returns it.
    [[nodiscard]] std::optional<recognition> classify(std::span<const float> logits,
                                                      std::size_t classes) const noexcept {
        return detail::classify_by(logits, classes, [this](double logit, double largest) {
            return std::exp((logit - largest) / temperature);
        });
    }
    /// Writes the logarithm of the probability of each class; nothing unless all logits are finite. Returns
    /// whether they are.
    [[nodiscard]] bool log_probabilities(std::span<const float> logits, std::span<double> to) const noexcept {
        double largest = -std::numeric_limits<double>::infinity(), sum = 0;
        for (const float logit : logits.first(to.size())) {
            if (!(std::abs(logit) <= std::numeric_limits<float>::max()))
                return false;
            largest = std::max(largest, static_cast<double>(logit));
        }
        for (const float logit : logits.first(to.size()))
            sum += std::exp((static_cast<double>(logit) - largest) / temperature);
        for (std::size_t c = 0; c < to.size(); ++c)
            to[c] = (static_cast<double>(logits[c]) - largest) / temperature - std::log(sum);
        return true;
    }
};

namespace detail {

/// Throws std::invalid_argument unless there are images, and for each a row of finite logits and a label.
inline void check_held_out(const std::string& caller, std::span<const float> logits, std::size_t outputs,
                           std::span<const std::size_t> labels, std::size_t classes) {
    if (labels.empty() || classes == 0 || classes > outputs || logits.size() != labels.size() * outputs)
        throw std::invalid_argument(caller + ": expected images with a row of " + std::to_string(outputs) +
                                    " logits each, of which " + std::to_string(classes) +
                                    " stand for a class, found " + std::to_string(labels.size()) +
                                    " labels and " + std::to_string(logits.size()) + " logits");
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i] >= classes)
            throw std::invalid_argument(caller + ": expected labels below " + std::to_string(classes) +
                                        ", found " + std::to_string(labels[i]));
        for (const float logit : logits.subspan(i * outputs, classes))
            if (!(std::abs(logit) <= std::numeric_limits<float>::max()))
                throw std::invalid_argument(caller + ": expected finite logits, found others for image " +
                                            std::to_string(i));
    }
}

} // namespace detail

/// Finds the temperature at which held-out images are most likely, by their logits (a row of `outputs` per
/// image, the first `classes` of which stand for a class) and labels. Take images that the network was not
/// trained on; the validation set will do. With few images the temperature stays near 1: ten nats for each
/// factor of e are added to their negative log-likelihood.
///
/// The result lies between 1/20 and 20. Throws std::invalid_argument unless there are images, a row of logits
/// and a label below `classes` for each, and all logits are finite.
[[nodiscard]] inline temperature_scaling fit_temperature(std::span<const float> logits, std::size_t outputs,
                                                         std::span<const std::size_t> labels,
                                                         std::size_t classes) {
    detail::check_held_out("fit_temperature", logits, outputs, labels, classes);
    std::vector<double> log_probabilities(classes);
    const auto loss = [&](double log_temperature) {
        const temperature_scaling tried{std::exp(log_temperature)};
        double sum = 10 * log_temperature * log_temperature;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            (void)tried.log_probabilities(logits.subspan(i * outputs, outputs), log_probabilities);
            sum -= log_probabilities[labels[i]];
        }
        return sum;
    };
    // Golden-section search: the loss has one minimum.
    const double ratio = (std::sqrt(5.0) - 1) / 2;
    double low = -std::log(20.0), high = std::log(20.0);
    double left = high - ratio * (high - low), right = low + ratio * (high - low);
    double at_left = loss(left), at_right = loss(right);
    for (int step = 0; step < 60; ++step) {
        if (at_left <= at_right) {
            high = right, right = left, at_right = at_left;
            left = high - ratio * (high - low), at_left = loss(left);
        } else {
            low = left, left = right, at_left = at_right;
            right = low + ratio * (high - low), at_right = loss(right);
        }
    }
    return {std::exp((low + high) / 2)};
}

}} // namespace tactnet
