#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Many classes from machines that separate two: their problems and solutions, and how they decide together.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Two classes: the samples, their sides, and the cost of an error on each.
struct binary_problem {
    std::vector<std::size_t> samples;
    std::vector<double> sides; ///< +1 or −1
    std::vector<double> costs; ///< C of the sample
};

/// The outcome of a solver.
struct solver_report {
    std::size_t iterations = 0;
    bool converged = false; ///< otherwise the limit was reached; the machine is usable, if not the best
    double violation = 0;   ///< of the optimality conditions
    double objective = 0;   ///< of the dual, as a minimum: ½ βᵀ K β − Σ y β
};

/// A trained machine of many classes and the outcome of its solvers.
template <class Machine>
struct svm_training_result {
    Machine machine;
    std::vector<solver_report> reports; ///< of each machine of two classes

    [[nodiscard]] bool converged() const {
        return std::all_of(reports.begin(), reports.end(), [](const auto& r) { return r.converged; });
    }
};

/// f(x) = Σ coefficients · K(sample, x) + offset
struct binary_solution {
    std::vector<double> coefficients;
    double offset = 0;
    solver_report report;
};

/// How machines of two classes decide between many.
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
    /// Only the named samples.
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
    /// Throws std::invalid_argument for fewer than two classes.
    void require_two() const {
        if (size() < 2)
            detail::throw_invalid_argument(
                {"labels: expected two classes or more, found ",
                 size() == 0 ? "no samples" : "only class " + std::to_string(labels.front())});
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
/// The number of machines of two classes that decide between so many classes.
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
            detail::throw_invalid_argument(
                {"cost of errors: expected a positive number, found ", std::to_string(c)});
    return costs;
}

namespace detail {

/// Throws std::invalid_argument for a weight of a class that no sample has, or for two of one class.
inline void check_class_weights(const class_members& classes, std::span<const class_weight> weights) {
    for (auto w = weights.begin(); w != weights.end(); ++w) {
        if (!std::binary_search(classes.labels.begin(), classes.labels.end(), w->label))
            throw_invalid_argument({"class weights: expected labels of the samples, found ", w->label});
        if (std::any_of(weights.begin(), w,
                        [&](const class_weight& other) { return other.label == w->label; }))
            throw_invalid_argument({"class weights: expected one for each label, found two for ", w->label});
    }
}
/// Throws std::invalid_argument for a tolerance that is no finite number above 0.
inline void check_tolerance(double tolerance) {
    if (!(tolerance > 0) || tolerance > std::numeric_limits<double>::max())
        throw_invalid_argument(
            {"tolerance: expected a finite number above 0, found ", std::to_string(tolerance)});
}

/// Throws std::invalid_argument when training so many classes would take more memory than allowed. The
/// problems and solutions of all machines are in memory at once; for one versus one they grow with the square
/// of the classes. `costs` are tried at once, with `values` kept for each machine.
inline void require_training_memory(std::size_t classes, std::size_t samples, multiclass scheme,
                                    std::size_t bytes, std::size_t costs = 1, std::size_t values = 0) {
    const auto k = static_cast<double>(classes), n = static_cast<double>(samples);
    const bool pairs = scheme == multiclass::one_versus_one;
    const double machines = pairs ? k * (k - 1) / 2 : k, each = pairs ? k - 1 : k;
    // Four lists and their blocks on the heap for each machine, four numbers for each of its samples; then
    // the table of coefficients, that of the support vectors and the packed one.
    const double of_machine = sizeof(binary_problem) + sizeof(binary_solution) + 4 * 32.0 +
                              static_cast<double>(values) * sizeof(double);
    const double needed =
        static_cast<double>(costs) * (machines * of_machine + n * each * (4 + 3) * sizeof(double));
    if (needed <= static_cast<double>(bytes))
        return;
    detail::throw_invalid_argument(
        {"support vector machines of ", classes, " classes from ", samples, " samples, ",
         pairs ? "one versus one" : "one versus rest", ": expected to need at most ", bytes,
         " bytes of memory (memory_bytes), found ", static_cast<std::uintmax_t>(std::min(needed, 1e18))});
}

} // namespace detail

/// The problem of each machine, in their order.
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

/// The class that the values of all machines decide for. One versus one: the first class with most votes; a
/// value above zero is a vote for the first of the pair.
[[nodiscard]] inline std::size_t winning_class(std::span<const double> values, std::size_t classes,
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

/// Assigns each sample to a fold of a cross-validation. Each class is shuffled by itself and dealt out in
/// turn, so that every fold has about as many samples of each class.
[[nodiscard]] inline std::vector<std::size_t>
deal_folds(const std::vector<std::vector<std::size_t>>& samples_of_classes, std::size_t samples,
           std::size_t folds, std::uint64_t seed) {
    std::vector<std::size_t> fold_of(samples);
    std::size_t next = 0;
    for (std::size_t c = 0; c < samples_of_classes.size(); ++c) {
        std::vector<std::size_t> members = samples_of_classes[c];
        random_stream(seed, random_purposes::split, static_cast<std::uint32_t>(c)).shuffle(members);
        for (const std::size_t sample : members)
            fold_of[sample] = next++ % folds;
    }
    return fold_of;
}

}} // namespace tactnet
