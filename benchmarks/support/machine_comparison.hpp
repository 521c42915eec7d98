#pragma once

#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/linear_machine.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

// For comparisons of support vector machines with what other libraries find.

namespace benchmark {

/// The share of samples on which both agree.
[[nodiscard]] inline double agreement(const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
    std::size_t same = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        same += a[i] == b[i] ? 1 : 0;
    return static_cast<double>(same) / static_cast<double>(a.size());
}

/// The weights of a class by its place, the offset last.
[[nodiscard]] inline std::vector<double> weights_of(const tactnet::linear_machine_parameters& parts,
                                                    std::size_t index) {
    const auto from = parts.weights.begin() + static_cast<std::ptrdiff_t>(index * parts.features);
    std::vector<double> weights(from, from + static_cast<std::ptrdiff_t>(parts.features));
    weights.push_back(parts.offsets[index]);
    return weights;
}

/// ½ ‖w‖² + C Σ loss of the machines of all classes together, in double. Labels are places of classes;
/// weights(place) as weights_of.
template <class Weights>
[[nodiscard]] double primal_objective(tactnet::feature_rows<> rows, std::span<const std::size_t> labels,
                                      tactnet::linear_loss loss, double cost, std::size_t classes,
                                      const Weights& weights) {
    double sum = 0;
    for (std::size_t c = 0; c < classes; ++c) {
        const std::vector<double> w = weights(c);
        for (const double value : w)
            sum += value * value / 2;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            double value = w.back();
            for (std::size_t f = 0; f < rows.features(); ++f)
                value += w[f] * static_cast<double>(rows.row(i)[f]);
            const double error = std::max(0.0, 1 - (labels[i] == c ? value : -value));
            sum += cost * (loss == tactnet::linear_loss::hinge ? error : error * error);
        }
    }
    return sum;
}

} // namespace benchmark
