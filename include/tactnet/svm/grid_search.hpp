#pragma once

#include <tactnet/runtime/folds.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/multiclass.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The settings to try: each kernel with each cost. Folds are scikit-learn's: StratifiedKFold of the samples
/// in their order, or GroupKFold where `groups` has the group of each sample, or LeaveOneGroupOut if `folds`
/// is 0 then.
template <svm_kernel Kernel>
struct search_grid {
    std::vector<Kernel> kernels;
    std::vector<double> costs;
    std::size_t folds = 5;
    std::vector<std::size_t> groups{};
};

/// The outcome of a grid search.
template <svm_kernel Kernel>
struct grid_search_result {
    /// Share of samples recognised by machines that have not seen them, mean over the folds, in the order of
    /// the grid: that of kernels[k] with costs[c] is accuracies[k * costs.size() + c].
    std::vector<double> accuracies;
    /// The best kernel; the first of equal ones.
    Kernel kernel;
    double cost = 0;
    double accuracy = 0;
    bool converged = true; ///< all machines of all parts
};

namespace detail {

/// The training samples of one fold by class, and the samples held out.
struct fold_samples {
    class_members classes;
    std::vector<std::size_t> held_out;
};

/// How many of the samples held out are recognised with each cost.
template <svm_kernel Kernel>
std::vector<std::size_t> count_recognised(const kernel_samples<Kernel>& samples, const fold_samples& fold,
                                          std::span<const std::size_t> labels, std::span<const double> costs,
                                          const kernel_training_options<Kernel>& options,
                                          thread_pool& threads, bool& converged) {
    const std::size_t k = fold.classes.size(), held = fold.held_out.size();
    const std::size_t machines = k > 1 ? machine_count(k, options.scheme) : 0;
    std::vector<std::vector<binary_problem>> problems;
    for (const double cost : costs)
        problems.push_back(machines == 0
                               ? std::vector<binary_problem>()
                               : binary_problems(fold.classes,
                                                 class_costs(fold.classes, cost, options.class_weights),
                                                 options.scheme));
    std::vector<std::vector<double>> values(costs.size() * machines);
    std::vector<char> done(values.size()); // not bool: threads write neighbours
    threads.for_each(values.size(), [&](std::size_t task) {
        const binary_problem& problem = problems[task / machines][task % machines];
        const binary_solution solution = samples.solve(problem, options.solver);
        done[task] = solution.report.converged ? 1 : 0;
        values[task] = samples.decision_values(problem, solution, fold.held_out);
    });
    converged = converged && std::find(done.begin(), done.end(), char{0}) == done.end();

    std::vector<std::size_t> recognised(costs.size());
    std::vector<double> own(machines);
    for (std::size_t c = 0; c < costs.size(); ++c)
        for (std::size_t h = 0; h < held; ++h) {
            for (std::size_t m = 0; m < machines; ++m)
                own[m] = values[c * machines + m][h];
            const std::size_t found = machines == 0 ? 0 : winning_class(own, k, options.scheme);
            recognised[c] += fold.classes.labels[found] == labels[fold.held_out[h]] ? 1 : 0;
        }
    return recognised;
}

} // namespace detail

/// Cross-validates every kernel with every cost, on all threads; the result is bit-identical on any number of
/// them. `options` has all other settings; standardisation is fitted on each part's training samples, as is a
/// γ of "scale". Products of the samples are computed once per part for all kernels. A class with fewer
/// samples than parts may be missing from the training of some: its samples there count as not recognised.
/// Throws std::invalid_argument as train_kernel_machine does, for a grid without kernels or costs, and for
/// fewer than two folds.
template <svm_kernel Kernel, std::size_t Features>
[[nodiscard]] grid_search_result<Kernel>
grid_search(const search_grid<Kernel>& grid, feature_rows<Features> rows, std::span<const std::size_t> labels,
            const kernel_training_options<Kernel>& options, thread_pool& threads) {
    if (grid.kernels.empty() || grid.costs.empty())
        throw std::invalid_argument("grid search: expected a kernel and a cost");
    check_samples(rows, labels);
    if (!grid.groups.empty() && grid.groups.size() != labels.size())
        detail::throw_invalid_argument({"grid search: expected the group of each of ", labels.size(),
                                        " samples, found ", grid.groups.size(), " groups"});
    const std::vector<std::size_t> fold_of = grid.groups.empty() ? stratified_folds(labels, grid.folds)
                                             : grid.folds == 0   ? one_group_folds(grid.groups)
                                                                 : group_folds(grid.groups, grid.folds);
    const std::size_t folds = detail::count_of(fold_of);
    const class_members classes(labels);
    classes.require_two();
    for (const double cost : grid.costs)
        static_cast<void>(class_costs(classes, cost, options.class_weights)); // throws before any work
    detail::check_class_weights(classes, options.class_weights);
    detail::require_training_memory(classes.size(), rows.size(), options.scheme, options.memory_bytes,
                                    grid.costs.size(), rows.size() / folds + 1);

    const std::size_t costs = grid.costs.size();
    grid_search_result<Kernel> result;
    result.accuracies.resize(grid.kernels.size() * costs);
    for (std::size_t f = 0; f < folds; ++f) {
        std::vector<std::size_t> training;
        detail::fold_samples fold;
        for (const std::size_t sample : all_samples(rows.size()))
            (fold_of[sample] == f ? fold.held_out : training).push_back(sample);
        fold.classes = class_members(labels, training);
        std::vector<float> values;
        for (const std::size_t sample : training) {
            const auto row = rows.row(sample);
            values.insert(values.end(), row.begin(), row.end());
        }
        const feature_rows<> chosen(values, rows.features());
        const auto fitted = fit_standardisation(chosen, options.standardise);
        const standardised_rows seen(chosen, fitted), all(rows, fitted);
        const measured_samples<Kernel> measured(all.rows(), options.solver.cache_bytes, threads);
        for (std::size_t k = 0; k < grid.kernels.size(); ++k) {
            const kernel_samples<Kernel> samples(measured, grid.kernels[k].fitted(seen.rows()), measured.gram,
                                                 threads);
            const std::vector<std::size_t> counts = detail::count_recognised(
                samples, fold, labels, grid.costs, options, threads, result.converged);
            for (std::size_t c = 0; c < costs; ++c)
                result.accuracies[k * costs + c] +=
                    static_cast<double>(counts[c]) / static_cast<double>(fold.held_out.size());
        }
    }
    for (double& accuracy : result.accuracies) // divided at the end: the mean of equal numbers is that number
        accuracy /= static_cast<double>(folds);
    const auto best = static_cast<std::size_t>(
        std::max_element(result.accuracies.begin(), result.accuracies.end()) - result.accuracies.begin());
    result.kernel = grid.kernels[best / costs];
    result.cost = grid.costs[best % costs];
    result.accuracy = result.accuracies[best];
    return result;
}

}} // namespace tactnet
