#pragma once

#include <tactnet/training/loop/progress.hpp>

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The loss is no longer a finite number.
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

/// The loss of a step tells of the steps before it, and nothing of its own.
inline void check_parameters(std::span<const float> values, const epoch_report& report) {
    for (const float value : values)
        if (!std::isfinite(value))
            diverged(report, "last step", "finite parameters", static_cast<double>(value));
}

/// A gradient whose square leaves single precision makes an optimiser's second moment infinite, for good: the
/// number would never move again, and look as good as any other.
inline void check_squares(std::span<const float> second_moments, const epoch_report& report) {
    for (const float moment : second_moments)
        if (!std::isfinite(moment))
            diverged(report, "its steps", "gradients whose squares are finite", static_cast<double>(moment));
}

} // namespace detail

} // namespace TACTNET_ARCH
} // namespace tactnet
