#pragma once

#include <tactnet/svm/dual_solver.hpp>
#include <tactnet/svm/feature_rows.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Many classes by machines of two.

namespace tactnet {
inline namespace TACTNET_ARCH {

enum class multiclass {
    one_versus_one, ///< a machine for every pair, which votes for one of both
    one_versus_rest ///< a machine for every class; the highest value wins
};

/// A factor on the cost of errors on samples of a class.
struct class_weight {
    std::size_t label = 0;
    double weight = 1;
};

/// The classes among some samples, by rising label, and their samples in order.
struct class_members {
    std::vector<std::size_t> labels;
    std::vector<std::vector<std::size_t>> samples;

    class_members() = default;
    explicit class_members(std::span<const std::size_t> all_labels)
        : class_members(all_labels, all_samples(all_labels.size())) {}
    /// Of the samples named alone.
    class_members(std::span<const std::size_t> all_labels, std::span<const std::size_t> named) {
        for (const std::size_t sample : named)
            labels.push_back(all_labels[sample]);
        std::sort(labels.begin(), labels.end());
        labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
        samples.resize(labels.size());
        for (const std::size_t sample : named)
            samples[index_of(all_labels[sample])].push_back(sample);
    }
    [[nodiscard]] std::size_t size() const { return labels.size(); }
    [[nodiscard]] std::size_t index_of(std::size_t label) const {
        return static_cast<std::size_t>(std::lower_bound(labels.begin(), labels.end(), label) -
                                        labels.begin());
    }
    /// Throws std::invalid_argument when there is nothing to tell apart.
    void require_two() const {
        if (size() < 2)
            throw std::invalid_argument(
                "labels: expected two classes or more, found " +
                (size() == 0 ? "no samples" : "only class " + std::to_string(labels.front())));
    }
};

/// The pairs of classes in the order of their machines: (0, 1), (0, 2), …, (1, 2), ….
[[nodiscard]] inline std::vector<std::pair<std::size_t, std::size_t>> class_pairs(std::size_t classes) {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t a = 0; a < classes; ++a)
        for (std::size_t b = a + 1; b < classes; ++b)
            pairs.emplace_back(a, b);
    return pairs;
}
[[nodiscard]] constexpr std::size_t machine_count(std::size_t classes, multiclass scheme) {
    return scheme == multiclass::one_versus_one ? classes * (classes - 1) / 2 : classes;
}

/// Cost of an error for each class. Throws std::invalid_argument unless all are positive numbers.
[[nodiscard]] inline std::vector<double> class_costs(const class_members& classes, double cost,
                                                     std::span<const class_weight> weights) {
    std::vector<double> costs(classes.size(), cost);
    for (const class_weight& w : weights)
        for (std::size_t c = 0; c < classes.size(); ++c)
            if (classes.labels[c] == w.label)
                costs[c] *= w.weight;
    for (const double c : costs)
        if (!(c > 0) || c > std::numeric_limits<double>::max())
            throw std::invalid_argument("cost of errors: expected a positive number, found " +
                                        std::to_string(c));
    return costs;
}

/// What each machine has to learn, in their order.
[[nodiscard]] inline std::vector<binary_problem>
binary_problems(const class_members& classes, std::span<const double> costs, multiclass scheme) {
    std::vector<binary_problem> problems;
    const auto add = [&](binary_problem& problem, std::size_t c, double side) {
        for (const std::size_t sample : classes.samples[c]) {
            problem.samples.push_back(sample);
            problem.sides.push_back(side);
            problem.costs.push_back(costs[c]);
        }
    };
    if (scheme == multiclass::one_versus_one) {
        for (const auto& [a, b] : class_pairs(classes.size())) {
            binary_problem& problem = problems.emplace_back();
            add(problem, a, 1);
            add(problem, b, -1);
        }
    } else {
        for (std::size_t own = 0; own < classes.size(); ++own) {
            binary_problem& problem = problems.emplace_back();
            for (std::size_t c = 0; c < classes.size(); ++c)
                add(problem, c, c == own ? 1 : -1);
        }
    }
    return problems;
}

/// The class that the machines' values stand for. One versus one: most votes, the first of those that have as
/// many; a value above zero is a vote for the first of the pair.
[[nodiscard]] inline std::size_t decide(std::span<const double> values, std::size_t classes,
                                        multiclass scheme) {
    const auto first_largest = [](const auto& list) {
        return static_cast<std::size_t>(std::max_element(list.begin(), list.end()) - list.begin());
    };
    if (scheme == multiclass::one_versus_rest)
        return first_largest(values);
    std::vector<std::size_t> votes(classes);
    std::size_t machine = 0;
    for (std::size_t a = 0; a < classes; ++a)
        for (std::size_t b = a + 1; b < classes; ++b)
            ++votes[values[machine++] > 0 ? a : b];
    return first_largest(votes);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
