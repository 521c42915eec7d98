#pragma once

#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/linear_machine.hpp>
#include <tactnet/svm/multiclass.hpp>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

// A linear machine for more features than samples. Coordinate descent reads all features of all samples in
// each round; the dual needs only the products of samples with each other, which are computed once for all
// classes.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Options of train_linear_machine_by_products.
struct linear_product_options {
    double cost = 1; ///< C, of an error on one sample
    std::vector<class_weight> class_weights{};
    bool standardise = false;
    /// `cache_bytes` bounds the matrix of all products, or else the rows kept by each thread.
    solver_options solver{};
};

/// Trains a machine per class against all others, with the hinge loss and an unregularised offset. It decides
/// as a kernel machine with the linear kernel, one versus rest, but stores a row of weights per class in
/// place of support vectors. Uses all threads; the result is bit-identical on any number of them. Throws
/// std::invalid_argument as train_linear_machine does, and for products beyond the range of single precision.
template <std::size_t Features>
[[nodiscard]] linear_training_result<Features>
train_linear_machine_by_products(feature_rows<Features> rows, std::span<const std::size_t> labels,
                                 const linear_product_options& options, thread_pool& threads) {
    check_samples(rows, labels);
    const class_members classes(labels);
    classes.require_two();
    detail::check_tolerance(options.solver.tolerance);
    detail::check_class_weights(classes, options.class_weights);
    const std::size_t features = rows.features();
    linear_machine_parameters parts;
    parts.features = features;
    parts.labels = classes.labels;
    parts.standardise = fit_standardisation(rows, options.standardise);
    const standardised_rows training(rows, parts.standardise);
    measured_samples<linear_kernel> measured(training.rows(), options.solver.cache_bytes, threads);
    const kernel_samples<linear_kernel> samples(measured, linear_kernel{}, std::move(measured.gram), threads);
    const std::vector<binary_problem> problems = binary_problems(
        classes, class_costs(classes, options.cost, options.class_weights), multiclass::one_versus_rest);
    parts.weights.resize(classes.size() * features);
    parts.offsets.resize(classes.size());
    std::vector<solver_report> reports(classes.size());
    threads.for_each(classes.size(), [&](std::size_t c) {
        const binary_solution solution = samples.solve(problems[c], options.solver);
        std::vector<double> sums(features);
        for (std::size_t s = 0; s < solution.coefficients.size(); ++s) {
            if (solution.coefficients[s] == 0)
                continue;
            const auto row = training.rows().row(problems[c].samples[s]);
            for (std::size_t f = 0; f < features; ++f)
                sums[f] += solution.coefficients[s] * double{row[f]};
        }
        for (std::size_t f = 0; f < features; ++f)
            parts.weights[c * features + f] = static_cast<float>(sums[f]);
        parts.offsets[c] = solution.offset;
        reports[c] = solution.report;
    });
    return {linear_machine<Features>(std::move(parts)), std::move(reports)};
}

}} // namespace tactnet
