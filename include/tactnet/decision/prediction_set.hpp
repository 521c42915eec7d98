#pragma once

#include <tactnet/decision/temperature.hpp>
#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Sets of classes that hold the right one as often as promised (split conformal prediction: Vovk et al.,
/// 2005): one class where the network is sure, several where it is not.
class prediction_set {
public:
    /// The classes with at least this probability, and the most likely one.
    explicit prediction_set(const temperature_scaling& scaling, double least_probability) noexcept
        : scaling_(scaling), least_(least_probability) {}

    /// Chooses the least probability by held-out images: logits and labels as for fit_temperature. If frames
    /// to come are exchangeable with these, the right class is in the set with a probability of `coverage` or
    /// more, whatever the network. With fewer than coverage ÷ (1 − coverage) images, 19 for 0.95, sets hold
    /// all classes.
    ///
    /// Throws std::invalid_argument unless `coverage` is above 0 and below 1, there are images, a row of
    /// logits and a label below `classes` for each, and all logits are finite.
    [[nodiscard]] static prediction_set fit(const temperature_scaling& scaling, double coverage,
                                            std::span<const float> logits, std::size_t outputs,
                                            std::span<const std::size_t> labels, std::size_t classes) {
        if (!(coverage > 0 && coverage < 1))
            throw std::invalid_argument("prediction_set: expected a coverage above 0 and below 1, found " +
                                        std::to_string(coverage));
        detail::check_held_out("prediction_set", logits, outputs, labels, classes);
        std::vector<double> of_right_class, logarithms(classes);
        for (std::size_t i = 0; i < labels.size(); ++i) {
            (void)scaling.log_probabilities(logits.subspan(i * outputs, outputs), logarithms);
            of_right_class.push_back(std::exp(logarithms[labels[i]]));
        }
        // The (n + 1) × coverage largest of n.
        const double rank = std::ceil(static_cast<double>(labels.size() + 1) * coverage);
        if (rank > static_cast<double>(labels.size()))
            return prediction_set(scaling, 0);
        std::sort(of_right_class.begin(), of_right_class.end(), std::greater<>());
        return prediction_set(scaling, of_right_class[static_cast<std::size_t>(rank) - 1]);
    }

    [[nodiscard]] double least_probability() const noexcept { return least_; }

    /// Writes whether each class is in the set for a frame, with as many `members` as there are classes.
    /// Returns how many are: 0 if a logit is not finite.
    std::size_t predict(std::span<const float> logits, std::span<bool> members) const noexcept {
        std::fill(members.begin(), members.end(), false);
        const auto most = classify_logits(logits, members.size());
        if (!most)
            return 0;
        double sum = 0;
        const auto share = [&](std::size_t c) {
            return std::exp((static_cast<double>(logits[c]) - static_cast<double>(logits[most->index])) /
                            scaling_.temperature);
        };
        for (std::size_t c = 0; c < members.size(); ++c)
            sum += share(c);
        std::size_t count = 0;
        for (std::size_t c = 0; c < members.size(); ++c) {
            members[c] = c == most->index || share(c) >= least_ * sum;
            count += members[c];
        }
        return count;
    }

private:
    temperature_scaling scaling_;
    double least_;
};

}} // namespace tactnet
