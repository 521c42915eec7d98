#pragma once

#include <tactnet/kernels/rows/packed.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/svm/solvers/coordinate_descent.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The parameters of a trained linear machine, which a file stores.
struct linear_machine_parameters {
    std::size_t features = 0;
    std::vector<std::size_t> labels; ///< of the classes, rising
    std::vector<float> weights;      ///< a row for each class
    std::vector<double> offsets;     ///< of each class
    std::optional<standardisation> standardise;

    /// Throws std::invalid_argument when the parts do not fit each other.
    void check() const {
        const std::size_t k = labels.size();
        if (k < 2 || features == 0 || weights.size() != k * features || offsets.size() != k ||
            std::adjacent_find(labels.begin(), labels.end(),
                               [](std::size_t a, std::size_t b) { return a >= b; }) != labels.end() ||
            (standardise &&
             (standardise->mean.size() != features || standardise->deviation.size() != features)))
            detail::throw_invalid_argument({"linear machine: ", k, " classes, ", features, " features, ",
                                            weights.size(), " weights and ", offsets.size(),
                                            " offsets do not fit each other"});
    }
};

/// A trained linear machine of any number of classes, one versus rest. Any number of threads may call const
/// members. The result of a row is bit-identical alone and in any batch.
template <std::size_t Features = dynamic_features>
class linear_machine {
public:
    /// Throws std::invalid_argument when the parameters do not fit each other or `Features`.
    explicit linear_machine(linear_machine_parameters parameters) : parts_(std::move(parameters)) {
        parts_.check();
        if (Features != dynamic_features && parts_.features != Features)
            detail::throw_invalid_argument(
                {"linear machine: expected ", Features, " features, found ", parts_.features});
        packed_ = kernels::packed_rows(classes(), features(),
                                       [&](std::size_t c) { return parts_.weights.data() + c * features(); });
    }

    [[nodiscard]] const linear_machine_parameters& parameters() const { return parts_; }
    [[nodiscard]] std::size_t features() const { return parts_.features; }
    [[nodiscard]] std::size_t classes() const { return parts_.labels.size(); }

    /// The value of every class for every row, row by row. Throws std::invalid_argument for a feature that is
    /// not finite.
    [[nodiscard]] std::vector<double> decision_values(feature_rows<Features> rows) const {
        check_rows(rows);
        std::vector<double> values;
        values.reserve(rows.size() * classes());
        detail::for_each_block(rows, bytes_each(),
                               [&](feature_rows<Features> block) { add_values(block, values); });
        return values;
    }
    /// The label of every row. Decision values are not kept, so memory grows with the labels alone.
    [[nodiscard]] std::vector<std::size_t> predict(feature_rows<Features> rows) const {
        check_rows(rows);
        std::vector<double> values;
        std::vector<std::size_t> labels;
        detail::for_each_block(
            rows, bytes_each() + classes() * sizeof(double), [&](feature_rows<Features> block) {
                values.clear();
                add_values(block, values);
                for (std::size_t i = 0; i < block.size(); ++i)
                    labels.push_back(
                        parts_.labels[winning_class(std::span(values).subspan(i * classes(), classes()),
                                                    classes(), multiclass::one_versus_rest)]);
            });
        return labels;
    }
    /// The label of one row.
    [[nodiscard]] std::size_t predict(std::span<const float, Features> row) const {
        return predict(feature_rows<Features>(row, row.size())).front();
    }

private:
    void check_rows(feature_rows<Features> rows) const {
        if (classes() == 0)
            throw std::logic_error("linear machine: it has been moved from");
        if (rows.features() != features())
            detail::throw_invalid_argument(
                {"linear machine: expected rows of ", features(), " features, found ", rows.features()});
        check_finite(rows);
    }
    /// The temporary memory of a row.
    std::size_t bytes_each() const { return (features() + packed_.padded_rows()) * sizeof(float); }
    void add_values(feature_rows<Features> rows, std::vector<double>& values) const {
        const standardised_rows used(rows, parts_.standardise);
        const std::size_t stride = packed_.padded_rows();
        aligned_vector<float> products(rows.size() * stride);
        packed_.products(used.rows().values().data(), rows.size(), features(), products.data(), stride);
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t c = 0; c < classes(); ++c)
                values.push_back(double{products[i * stride + c]} + parts_.offsets[c]);
    }

    linear_machine_parameters parts_;
    kernels::packed_rows packed_;
};

/// Options of train_linear_machine.
struct linear_training_options {
    double cost = 1; ///< C, of an error on one sample
    std::vector<class_weight> class_weights{};
    double bias = 1; ///< the constant feature whose weight gives the offset; 0: no offset
    bool standardise = false;
    descent_options solver{};
};

/// A trained linear machine, with a report for each class.
template <std::size_t Features>
using linear_training_result = svm_training_result<linear_machine<Features>>;

/// Trains one machine for each class among the labels, on all threads; the result is bit-identical on any
/// number of them. Throws std::invalid_argument for a feature that is not finite (with its row and column),
/// for fewer than two classes, if the numbers of labels and rows differ, for a tolerance that is not above 0,
/// and for weights of classes without samples. Features above about 10^21 leave the range of single
/// precision: then converged() is false.
template <std::size_t Features>
[[nodiscard]] linear_training_result<Features>
train_linear_machine(feature_rows<Features> rows, std::span<const std::size_t> labels,
                     const linear_training_options& options, thread_pool& threads) {
    check_samples(rows, labels);
    const class_members classes(labels);
    classes.require_two();
    detail::check_tolerance(options.solver.tolerance);
    detail::check_class_weights(classes, options.class_weights);
    linear_machine_parameters parts;
    parts.standardise = fit_standardisation(rows, options.standardise);
    const standardised_rows training(rows, parts.standardise);
    const std::vector<double> class_cost = class_costs(classes, options.cost, options.class_weights);
    std::vector<double> costs;
    for (const std::size_t label : labels)
        costs.push_back(class_cost[classes.index_of(label)]);

    const biased_rows biased(training.rows(), options.bias);
    std::vector<descent_solution> solutions(classes.size());
    threads.for_each(classes.size(), [&](std::size_t c) {
        std::vector<double> sides(rows.size(), -1.0);
        for (const std::size_t sample : classes.samples[c])
            sides[sample] = 1;
        solutions[c] =
            coordinate_descent(biased, sides, costs, options.solver, static_cast<std::uint32_t>(c)).solve();
        // For all classes together, they would grow with the square of the classes.
        solutions[c].coefficients = std::vector<double>();
    });

    parts.features = rows.features();
    parts.labels = classes.labels;
    std::vector<solver_report> reports;
    for (const descent_solution& solution : solutions) {
        for (std::size_t f = 0; f < parts.features; ++f)
            parts.weights.push_back(static_cast<float>(solution.weights[f]));
        parts.offsets.push_back(solution.weights[parts.features] *
                                static_cast<double>(static_cast<float>(options.bias)));
        reports.push_back(solution.report);
    }
    return {linear_machine<Features>(std::move(parts)), std::move(reports)};
}

// A linear machine for more features than samples. Coordinate descent reads all features of all samples in
// each round; the dual needs only the products of samples with each other, which are computed once for all
// classes.

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
