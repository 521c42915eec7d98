#pragma once

#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/kernel/gram_matrix.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/svm/kernel_machine.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/svm/solvers/sequential_minimal_optimisation.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

// Samples of a training set for solvers. Problems over the same samples share one kernel matrix if it fits
// into the allowed memory; searches for γ share its distances.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Samples placed for a kernel, with the products or squared distances of all pairs if these fit.
template <svm_kernel Kernel>
struct measured_samples {
    kernel_space<Kernel> space;
    placed_rows rows;
    std::optional<gram_matrix> gram;

    /// The samples must outlive this.
    measured_samples(feature_rows<> samples, std::size_t bytes, thread_pool& threads)
        : space(samples), rows(space.place(samples)) {
        if (gram_matrix::bytes(samples.size()) > static_cast<double>(bytes))
            return;
        const std::vector<std::size_t> all = all_samples(samples.size());
        gram = gram_matrix::measured(rows, kernel_columns<Kernel>(rows, all, space.scale()), threads);
    }
};

/// Samples with the values of one kernel.
template <svm_kernel Kernel>
class kernel_samples {
public:
    /// `gram` is `measured.gram`, copied or moved; `measured` must outlive this.
    kernel_samples(const measured_samples<Kernel>& measured, const Kernel& kernel,
                   std::optional<gram_matrix> gram, thread_pool& threads)
        : measured_(&measured), kernel_(kernel), gram_(std::move(gram)) {
        if (gram_)
            gram_->apply(kernel_, measured.space.unit(), threads);
    }

    [[nodiscard]] binary_solution solve(const binary_problem& problem, const solver_options& options) const {
        return with_rows(
            [&](auto rows) { return sequential_minimal_optimisation(problem, rows, options).solve(); });
    }
    /// The decision values of a machine for some of the samples.
    [[nodiscard]] std::vector<double> decision_values(const binary_problem& problem,
                                                      const binary_solution& solution,
                                                      std::span<const std::size_t> samples) const {
        std::vector<std::size_t> support;
        std::vector<double> coefficients;
        for (std::size_t k = 0; k < problem.samples.size(); ++k)
            if (solution.coefficients[k] != 0) {
                support.push_back(problem.samples[k]);
                coefficients.push_back(solution.coefficients[k]);
            }
        return with_rows([&](auto rows) {
            rows.select(support);
            std::vector<float> row(support.size());
            std::vector<double> values;
            for (const std::size_t sample : samples) {
                rows.fill(sample, row.data());
                double value = solution.offset;
                for (std::size_t k = 0; k < support.size(); ++k)
                    value += coefficients[k] * double{row[k]};
                values.push_back(value);
            }
            return values;
        });
    }

private:
    template <class Body>
    auto with_rows(const Body& body) const {
        if (gram_)
            return body(stored_kernel_rows(*gram_));
        return body(computed_kernel_rows<Kernel>(measured_->rows, measured_->space, kernel_));
    }

    const measured_samples<Kernel>* measured_;
    Kernel kernel_;
    std::optional<gram_matrix> gram_;
};

/// Options of train_kernel_machine.
template <svm_kernel Kernel>
struct kernel_training_options {
    Kernel kernel{};
    double cost = 1; ///< C, of an error on one sample
    std::vector<class_weight> class_weights{};
    multiclass scheme = multiclass::one_versus_one;
    bool standardise = false;
    /// Parts of the cross-validation that probabilities are fitted on, 2 or more; 0: no probabilities.
    std::size_t probability_folds = 0;
    std::uint64_t seed = 1; ///< of the division into these parts
    /// `solver.cache_bytes` bounds the matrix of all pairs, or else the rows kept by each thread.
    solver_options solver{};
    /// The most memory of the machines of all classes together; a problem that needs more is rejected.
    /// Estimated without the features and what `solver.cache_bytes` bounds.
    std::size_t memory_bytes = 0xffff'ffff;
};

/// A trained kernel machine, with a report for each machine of two classes.
template <svm_kernel Kernel, std::size_t Features>
using kernel_training_result = svm_training_result<kernel_machine<Kernel, Features>>;

namespace detail {

/// The sigmoid of one machine, on values of machines that have not seen the samples. If a fold leaves one
/// side without samples, the other side is the answer, as in LIBSVM.
template <svm_kernel Kernel>
platt_sigmoid cross_validated_sigmoid(const kernel_samples<Kernel>& samples, const binary_problem& problem,
                                      const solver_options& options, std::size_t max_folds,
                                      std::uint64_t seed) {
    const std::size_t n = problem.samples.size(), folds = std::min(max_folds, n);
    std::vector<std::vector<std::size_t>> sides(2);
    for (std::size_t k = 0; k < n; ++k)
        sides[problem.sides[k] > 0 ? 0 : 1].push_back(k);
    const std::vector<std::size_t> fold_of = deal_folds(sides, n, folds, seed);
    std::vector<double> values(n);
    for (std::size_t fold = 0; fold < folds; ++fold) {
        binary_problem training;
        std::vector<std::size_t> held_out, held_out_samples;
        for (std::size_t k = 0; k < n; ++k) {
            if (fold_of[k] == fold) {
                held_out.push_back(k);
                held_out_samples.push_back(problem.samples[k]);
            } else {
                training.samples.push_back(problem.samples[k]);
                training.sides.push_back(problem.sides[k]);
                training.costs.push_back(problem.costs[k]);
            }
        }
        const auto first =
            std::count_if(training.sides.begin(), training.sides.end(), [](double s) { return s > 0; });
        const auto all = static_cast<std::ptrdiff_t>(training.sides.size());
        if (first == 0 || first == all) {
            for (const std::size_t k : held_out)
                values[k] = all == 0 ? 0 : (first == 0 ? -1 : 1);
            continue;
        }
        const std::vector<double> found =
            samples.decision_values(training, samples.solve(training, options), held_out_samples);
        for (std::size_t h = 0; h < held_out.size(); ++h)
            values[held_out[h]] = found[h];
    }
    return fit_platt_sigmoid(values, problem.sides);
}

/// Gathers the support vectors of all machines, by class.
template <svm_kernel Kernel>
void gather_support(kernel_machine_parameters<Kernel>& parts, feature_rows<> rows,
                    const class_members& classes, const std::vector<binary_problem>& problems,
                    const std::vector<binary_solution>& solutions) {
    const std::size_t k = classes.size(), each = parts.coefficients_each();
    std::vector<std::size_t> class_of(rows.size());
    for (std::size_t c = 0; c < k; ++c)
        for (const std::size_t sample : classes.samples[c])
            class_of[sample] = c;
    std::vector<double> coefficients(rows.size() * each);
    std::vector<bool> supports(rows.size());
    const auto pairs = class_pairs(k);
    for (std::size_t m = 0; m < problems.size(); ++m)
        for (std::size_t s = 0; s < problems[m].samples.size(); ++s) {
            const std::size_t sample = problems[m].samples[s];
            std::size_t place = m;
            if (parts.scheme == multiclass::one_versus_one)
                place = class_of[sample] == pairs[m].first ? pairs[m].second - 1 : pairs[m].first;
            coefficients[sample * each + place] = solutions[m].coefficients[s];
            supports[sample] = supports[sample] || solutions[m].coefficients[s] != 0;
        }
    for (std::size_t c = 0; c < k; ++c) {
        std::size_t count = 0;
        for (const std::size_t sample : classes.samples[c])
            if (supports[sample]) {
                const auto row = rows.row(sample);
                parts.support_vectors.insert(parts.support_vectors.end(), row.begin(), row.end());
                const auto from = coefficients.begin() + static_cast<std::ptrdiff_t>(sample * each);
                parts.coefficients.insert(parts.coefficients.end(), from,
                                          from + static_cast<std::ptrdiff_t>(each));
                ++count;
            }
        parts.support_counts.push_back(count);
    }
}

} // namespace detail

/// Trains machines for all classes among the labels, on all threads; the result is bit-identical on any
/// number of them. Throws std::invalid_argument for a feature that is not finite (with its row and column),
/// for fewer than two classes or more than fit into `memory_bytes`, if the numbers of labels and rows differ,
/// and for options without a meaning: a tolerance that is not above 0, weights of classes without samples,
/// one part to cross-validate with. More parts than samples of a machine are one for each sample.
template <svm_kernel Kernel, std::size_t Features>
[[nodiscard]] kernel_training_result<Kernel, Features>
train_kernel_machine(feature_rows<Features> rows, std::span<const std::size_t> labels,
                     const kernel_training_options<Kernel>& options, thread_pool& threads) {
    check_samples(rows, labels);
    const class_members classes(labels);
    classes.require_two();
    detail::check_tolerance(options.solver.tolerance);
    detail::check_class_weights(classes, options.class_weights);
    if (options.probability_folds == 1)
        throw std::invalid_argument(
            "probabilities: expected 2 parts or more to cross-validate with, found 1");
    detail::require_training_memory(classes.size(), rows.size(), options.scheme, options.memory_bytes);

    kernel_machine_parameters<Kernel> parts;
    parts.standardise = fit_standardisation(rows, options.standardise);
    const standardised_rows training(rows, parts.standardise);
    parts.kernel = options.kernel.fitted(training.rows());
    parts.scheme = options.scheme;
    parts.features = rows.features();
    parts.labels = classes.labels;

    measured_samples<Kernel> measured(training.rows(), options.solver.cache_bytes, threads);
    const kernel_samples<Kernel> samples(measured, parts.kernel, std::move(measured.gram), threads);
    const std::vector<binary_problem> problems =
        binary_problems(classes, class_costs(classes, options.cost, options.class_weights), options.scheme);
    std::vector<binary_solution> solutions(problems.size());
    if (options.probability_folds > 0)
        parts.sigmoids.resize(problems.size());
    threads.for_each(problems.size(), [&](std::size_t m) {
        solutions[m] = samples.solve(problems[m], options.solver);
        if (options.probability_folds > 0)
            parts.sigmoids[m] = detail::cross_validated_sigmoid(samples, problems[m], options.solver,
                                                                options.probability_folds, options.seed);
    });

    std::vector<solver_report> reports;
    for (const binary_solution& solution : solutions) {
        parts.offsets.push_back(solution.offset);
        reports.push_back(solution.report);
    }
    detail::gather_support(parts, training.rows(), classes, problems, solutions);
    return {kernel_machine<Kernel, Features>(std::move(parts)), std::move(reports)};
}

}} // namespace tactnet
