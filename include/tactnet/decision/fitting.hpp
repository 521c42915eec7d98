#pragma once

#include <tactnet/decision/probabilities.hpp>
#include <tactnet/networks/model.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// What is chosen by held-out images, before a network is deployed.

namespace tactnet { inline namespace TACTNET_ARCH {

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

/// The bound that a further score, exchangeable with these, does not exceed with a probability of `coverage`:
/// the smallest of them that ⌈(n + 1) coverage⌉ do not exceed; infinity if there are too few.
[[nodiscard]] inline double conformal_bound(std::vector<double> scores, double coverage) {
    std::sort(scores.begin(), scores.end());
    const double rank = std::ceil(static_cast<double>(scores.size() + 1) * coverage);
    return rank > static_cast<double>(scores.size()) ? std::numeric_limits<double>::infinity()
                                                     : scores[static_cast<std::size_t>(rank) - 1];
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

/// Chooses the least probability of a prediction_set by held-out images (split conformal prediction: Vovk et
/// al., 2005): logits and labels as for fit_temperature. If frames to come are exchangeable with these, the
/// right class is in the set with a probability of `coverage` or more, whatever the network. With fewer than
/// coverage ÷ (1 − coverage) images, 19 for 0.95, sets hold all classes.
///
/// Throws std::invalid_argument unless `coverage` is above 0 and below 1, the temperature is one
/// (is_temperature), there are images, a row of logits and a label below `classes` for each, and all logits
/// are finite.
[[nodiscard]] inline prediction_set fit_prediction_set(const temperature_scaling& scaling, double coverage,
                                                       std::span<const float> logits, std::size_t outputs,
                                                       std::span<const std::size_t> labels,
                                                       std::size_t classes) {
    if (!(coverage > 0 && coverage < 1))
        throw std::invalid_argument("fit_prediction_set: expected a coverage above 0 and below 1, found " +
                                    std::to_string(coverage));
    detail::check_temperature("fit_prediction_set", scaling.temperature);
    detail::check_held_out("fit_prediction_set", logits, outputs, labels, classes);
    // Probabilities of the right class, negated: the smallest come last.
    std::vector<double> negated, logarithms(classes);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        (void)scaling.log_probabilities(logits.subspan(i * outputs, outputs), logarithms);
        negated.push_back(-std::exp(logarithms[labels[i]]));
    }
    return prediction_set(scaling, std::max(0.0, -detail::conformal_bound(std::move(negated), coverage)));
}

/// Chooses the largest distance from a class mean that is still known, by the distances of held-out touches
/// of known objects: of further touches like these, at most a share of `false_alarms` is taken for unknown.
/// Infinite with fewer than 1 ÷ false_alarms − 1 touches, which cannot promise that.
///
/// Throws std::invalid_argument unless `false_alarms` is above 0 and below 1, and no distance is NaN.
[[nodiscard]] inline double fit_largest_distance(std::span<const double> scores, double false_alarms) {
    if (!(false_alarms > 0 && false_alarms < 1))
        throw std::invalid_argument(
            "fit_largest_distance: expected a share of false alarms above 0 and below 1, found " +
            std::to_string(false_alarms));
    for (const double score : scores)
        if (std::isnan(score))
            throw std::invalid_argument("fit_largest_distance: expected distances, found NaN");
    return detail::conformal_bound({scores.begin(), scores.end()}, 1 - false_alarms);
}

}} // namespace tactnet
