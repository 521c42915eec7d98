#pragma once

#include <tactnet/text/message.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// One epoch of a training.
struct epoch_report {
    std::size_t epoch = 0;                                                 ///< counted from 1
    double rate = 0;                                                       ///< learning rate of its last step
    double loss = 0;                                                       ///< mean training loss
    double validation_loss = std::numeric_limits<double>::quiet_NaN();     ///< NaN where none was due
    double validation_accuracy = std::numeric_limits<double>::quiet_NaN(); ///< NaN where none was due
};

/// Stops when the validation loss has not fallen below its smallest value for `patience` checks. A patience
/// of 0 never stops.
struct early_stopping {
    std::size_t patience = 0;
    double smallest = std::numeric_limits<double>::infinity(); ///< loss so far
    std::size_t waited = 0;                                    ///< checks since then

    /// Adds a validation loss; returns whether to stop.
    bool check(double loss) {
        waited = loss < smallest ? 0 : waited + 1;
        if (waited == 0)
            smallest = loss;
        return patience > 0 && waited >= patience;
    }
};

/// The state of a training besides the arrays of its network. Files store it as numbers.
struct training_progress {
    std::uint64_t steps = 0;
    // Losses of validations; infinite before the first.
    double best_loss = std::numeric_limits<double>::infinity(), smoothed_loss = best_loss,
           smallest_loss = best_loss;
    std::size_t waited = 0; ///< validations since the smallest loss
    bool stopped = false;
    std::vector<epoch_report> history;

    /// Adds a validation loss; returns whether the network is the best so far. Losses are smoothed, since
    /// over few images one lucky epoch long before the end would otherwise be kept.
    bool validated(double loss) {
        smoothed_loss = std::isfinite(smoothed_loss) ? 0.8 * smoothed_loss + 0.2 * loss : loss;
        if (!(smoothed_loss <= best_loss))
            return false;
        best_loss = smoothed_loss;
        return true;
    }

    [[nodiscard]] std::vector<double> numbers() const {
        std::vector<double> n{static_cast<double>(steps),  best_loss,          smoothed_loss, smallest_loss,
                              static_cast<double>(waited), stopped ? 1.0 : 0.0};
        for (const epoch_report& e : history)
            n.insert(n.end(), {e.rate, e.loss, e.validation_loss, e.validation_accuracy});
        return n;
    }

    /// Restores the result of `numbers`. Throws std::invalid_argument if no training of at most `max_epochs`
    /// with so many steps in each can have it.
    [[nodiscard]] static training_progress from(std::span<const double> n, std::size_t max_epochs,
                                                std::size_t steps_per_epoch) {
        if (n.size() < 6 || (n.size() - 6) % 4 != 0)
            detail::throw_invalid_argument(
                {"progress of a training: expected 6 numbers and 4 for each epoch, "
                 "found ",
                 n.size()});
        const std::size_t epochs = (n.size() - 6) / 4, steps = epochs * steps_per_epoch;
        if (epochs > max_epochs)
            detail::throw_invalid_argument(
                {"progress of a training: expected at most ", max_epochs, " epochs, found ", epochs});
        const auto require = [&](bool right, std::size_t index, const std::string& expected) {
            if (!right)
                detail::throw_invalid_argument({"progress of a training, number ", index, ": expected ",
                                                expected, ", found ", std::to_string(n[index])});
        };
        const auto finite = [](double v) { return std::isfinite(v) && v >= 0; };
        require(n[0] == static_cast<double>(steps), 0,
                std::to_string(steps) + " steps in " + std::to_string(epochs) + " epochs");
        for (const std::size_t i : {1u, 2u, 3u})
            require(n[i] >= 0, i, "a loss, or infinity before the first");
        require(n[4] >= 0 && n[4] <= static_cast<double>(epochs) && n[4] == std::floor(n[4]), 4,
                "validations, 0 to " + std::to_string(epochs));
        require(n[5] == 0 || n[5] == 1, 5, "0, or 1 for a training that stopped");
        training_progress p{.steps = steps,
                            .best_loss = n[1],
                            .smoothed_loss = n[2],
                            .smallest_loss = n[3],
                            .waited = static_cast<std::size_t>(n[4]),
                            .stopped = n[5] != 0,
                            .history = {}};
        for (std::size_t i = 6; i < n.size(); i += 4) {
            require(finite(n[i]), i, "a learning rate");
            require(finite(n[i + 1]), i + 1, "a training loss");
            const bool none = std::isnan(n[i + 2]) && std::isnan(n[i + 3]);
            require(none || finite(n[i + 2]), i + 2, "a validation loss");
            require(none || (n[i + 3] >= 0 && n[i + 3] <= 1), i + 3, "an accuracy, 0 to 1");
            p.history.push_back({p.history.size() + 1, n[i], n[i + 1], n[i + 2], n[i + 3]});
        }
        return p;
    }
};

/// Thrown when a loss, a parameter or the square of a gradient is not finite.
struct training_diverged : std::runtime_error {
    using std::runtime_error::runtime_error;
};

namespace detail {

/// Throws training_diverged for the epoch of a report; `where` follows its number in the message.
[[noreturn]] inline void diverged(const epoch_report& report, const std::string& where,
                                  const std::string& expected, double found) {
    throw training_diverged("training diverged in epoch " + std::to_string(report.epoch) + ", " + where +
                            ": expected " + expected + ", found " + std::to_string(found) +
                            "; lower the learning rate (now " + std::to_string(report.rate) + ")");
}

inline void check_loss(double loss, const epoch_report& report, const std::string& where) {
    if (!std::isfinite(loss))
        diverged(report, where, "a finite loss", loss);
}

/// Checks the result of the last step, which no loss shows.
inline void check_parameters(std::span<const float> values, const epoch_report& report) {
    for (const float value : values)
        if (!std::isfinite(value))
            diverged(report, "last step", "finite parameters", static_cast<double>(value));
}

/// A gradient whose square overflows single precision makes a second moment of the optimiser infinite for
/// good: that parameter would never change again.
inline void check_squares(std::span<const float> second_moments, const epoch_report& report) {
    for (const float moment : second_moments)
        if (!std::isfinite(moment))
            diverged(report, "its steps", "gradients whose squares are finite", static_cast<double>(moment));
}

} // namespace detail

}} // namespace tactnet
