#pragma once

#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/kernel/gram_matrix.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/svm/solvers/sequential_minimal_optimisation.hpp>

#include <cstddef>
#include <optional>
#include <span>
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

}} // namespace tactnet
