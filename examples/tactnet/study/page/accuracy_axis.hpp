#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

/// The axis of accuracies of a picture, in percent. Between 98 and 99 % half of all errors go, as between 80
/// and 90: stretched towards 100 %, so that halving the errors is the same height everywhere, unless
/// something errs hardly at all.
struct accuracy_axis {
    double lowest = 100, highest = 0;

    void add(double mean, double deviation) {
        lowest = std::min(lowest, mean - deviation);
        highest = std::max(highest, mean);
    }
    [[nodiscard]] double first() const { return std::max(0.0, 5 * std::floor((lowest - 1) / 5)); }
    [[nodiscard]] bool stretched() const { return highest <= 99.4; }
    [[nodiscard]] double last() const { return stretched() ? 99.7 : 100; }
    /// How high an accuracy stands, 0 … 1.
    [[nodiscard]] double height(double accuracy) const {
        const auto place = [&](double a) { return stretched() ? -std::log(100 - a) : a; };
        return (place(std::min(accuracy, last())) - place(first())) / (place(last()) - place(first()));
    }
    [[nodiscard]] std::string text() const {
        std::string all = fmt::format("set ylabel 'test accuracy, %'\nset yrange [{}:{}]\n", first(), last());
        if (stretched())
            all += "set nonlinear y via -log10(100.0 - y) inverse 100.0 - 10.0**(-y)\n"
                   "set ytics (0, 20, 40, 50, 60, 70, 80, 90, 95, 97, 98, 99, 99.5)\n";
        return all;
    }
};
