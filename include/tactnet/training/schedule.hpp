#pragma once

#include <tactnet/detail/config.hpp>

#include <cmath>
#include <numbers>
#include <variant>

// Learning rates over the epochs of a training.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A constant learning rate.
struct constant_rate {};

/// The learning rate is multiplied by `factor` every `period` epochs.
struct step_drop {
    double period = 100;
    double factor = 0.1;
};

/// One cycle (Smith and Topin, 2018): the learning rate rises from rate / 25 along half a cosine over the
/// `warm_up` share of all steps, then falls along another to 1e-6 of the rate.
struct one_cycle {
    double warm_up = 0.25;
};

/// A learning-rate schedule.
using schedule = std::variant<constant_rate, step_drop, one_cycle>;

/// The learning rate of a constant schedule.
[[nodiscard]] inline double rate_at(const constant_rate&, double rate, double, double) {
    return rate;
}
/// The learning rate after the drops so far.
[[nodiscard]] inline double rate_at(const step_drop& rule, double rate, double epoch, double) {
    return rate * std::pow(rule.factor, std::floor(epoch / rule.period));
}
/// The learning rate within one cycle.
[[nodiscard]] inline double rate_at(const one_cycle& rule, double rate, double epoch, double epochs) {
    constexpr double start = 1.0 / 25, finish = 1e-6;
    const auto cosine = [](double from, double to, double share) {
        return to + (from - to) * (1 + std::cos(std::numbers::pi * share)) / 2;
    };
    const double share = epoch / epochs;
    if (share < rule.warm_up)
        return rate * cosine(start, 1, share / rule.warm_up);
    return rate * cosine(1, finish, (share - rule.warm_up) / (1 - rule.warm_up));
}

/// The learning rate after `epoch` (with its fraction) of `epochs`; `rate` is the highest.
[[nodiscard]] inline double rate_at(const schedule& rule, double rate, double epoch, double epochs) {
    return std::visit([&](const auto& chosen) { return rate_at(chosen, rate, epoch, epochs); }, rule);
}

}} // namespace tactnet
