#pragma once

#include <tactnet/kernels/rows/working_set.hpp>
#include <tactnet/svm/kernel/gram_matrix.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

// Sequential minimal optimisation of the support vector machine's dual (Platt 1998; working sets of second
// order by Fan, Chen and Lin, JMLR 6, 2005; shrinking by Joachims 1999). Written for signed coefficients β =
// y α:
//     maximise Σ y β − ½ βᵀ K β,  Σ β = 0,  low ≤ β ≤ high,
// with the gradient g = y − K β. A pair of samples is optimal when none that may rise has a larger g than one
// that may fall.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Options of the solver.
struct solver_options {
    double tolerance = 1e-3;         ///< largest violation of the optimality conditions
    std::size_t iteration_limit = 0; ///< 0: ten million, or 100 per sample if that is more
    bool shrinking = true;           ///< leave out samples that seem settled at a bound
    std::size_t cache_bytes = std::size_t{256} << 20;
};

/// Rows: select(samples), fill(sample, out), diagonal(sample), as stored_kernel_rows.
template <class Rows>
class sequential_minimal_optimisation {
public:
    sequential_minimal_optimisation(const binary_problem& problem, Rows& rows, const solver_options& options)
        : problem_(problem),
          rows_(rows),
          options_(options),
          count_(problem.samples.size()),
          beta_(count_),
          cache_(count_, options.cache_bytes) {}

    [[nodiscard]] binary_solution solve() {
        const std::size_t limit = options_.iteration_limit > 0
                                      ? options_.iteration_limit
                                      : std::max<std::size_t>(10'000'000, 100 * count_);
        activate_all();
        kernels::selected_sample rising = kernels::steepest(gradient_.data(), up_.data(), padded());
        std::size_t until_shrinking = shrinking_interval();
        solver_report report;
        while (true) {
            const float* row = kernel_row(rising.index);
            const kernels::selected_partner partner =
                kernels::select_partner(gradient_.data(), low_.data(), row, diagonal_.data(),
                                        diagonal_[rising.index], rising.value, least_curvature, padded());
            report.violation = std::max(rising.value - partner.lowest, 0.0);
            report.converged = !(report.violation > options_.tolerance);
            if (report.converged || report.iterations == limit) {
                if (active_.size() == count_)
                    break;
                activate_all();
                rising = kernels::steepest(gradient_.data(), up_.data(), padded());
                until_shrinking = shrinking_interval();
                continue;
            }
            ++report.iterations;
            rising = step(rising.index, partner.sample.index, row);
            if (options_.shrinking && --until_shrinking == 0) {
                until_shrinking = shrinking_interval();
                if (shrink(rising.value))
                    rising = kernels::steepest(gradient_.data(), up_.data(), padded());
            }
        }
        return finish(report, rising.value);
    }

private:
    /// For pairs of samples that the kernel cannot distinguish.
    static constexpr double least_curvature = 1e-12;

    [[nodiscard]] std::size_t padded() const { return gradient_.size(); }
    [[nodiscard]] std::size_t shrinking_interval() const { return std::min<std::size_t>(count_, 1000); }
    [[nodiscard]] double high(std::size_t k) const { return problem_.sides[k] > 0 ? problem_.costs[k] : 0; }
    [[nodiscard]] double low(std::size_t k) const { return problem_.sides[k] > 0 ? 0 : -problem_.costs[k]; }
    [[nodiscard]] const float* kernel_row(std::size_t position) {
        return cache_.row(active_[position], active_.size(),
                          [&](float* out) { rows_.fill(problem_.samples[active_[position]], out); });
    }

    /// Moves along one pair of coordinates as far as the curvature or a bound allows.
    kernels::selected_sample step(std::size_t i, std::size_t j, const float* row_i) {
        const float* row_j = kernel_row(j);
        const std::size_t a = active_[i], b = active_[j];
        const double curvature =
            std::max(diagonal_[i] + diagonal_[j] - 2 * double{row_i[j]}, least_curvature);
        const double room_i = high(a) - beta_[a], room_j = beta_[b] - low(b);
        const double step = (gradient_[i] - gradient_[j]) / curvature;
        // Exactly at a bound, so that the sample counts as bound.
        if (step >= room_i && room_i <= room_j) {
            beta_[a] = high(a);
            beta_[b] = std::max(beta_[b] - room_i, low(b));
        } else if (step >= room_j) {
            beta_[b] = low(b);
            beta_[a] = std::min(beta_[a] + room_j, high(a));
        } else {
            beta_[a] += step;
            beta_[b] -= step;
        }
        bound(i);
        bound(j);
        return kernels::update_gradient(gradient_.data(), row_i, row_j, std::min({step, room_i, room_j}),
                                        up_.data(), padded());
    }
    /// Stores in which directions a sample may move.
    void bound(std::size_t position) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const std::size_t k = active_[position];
        up_[position] = beta_[k] < high(k) ? 0 : -infinity;
        low_[position] = beta_[k] > low(k) ? 0 : infinity;
    }

    /// Activates all samples, and recomputes the gradient, free of accumulated rounding errors.
    void activate_all() {
        active_.resize(count_);
        std::iota(active_.begin(), active_.end(), std::size_t{0});
        cache_.clear();
        resize();
        std::copy(problem_.sides.begin(), problem_.sides.end(), gradient_.begin());
        for (std::size_t k = 0; k < count_; ++k) {
            diagonal_[k] = rows_.diagonal(problem_.samples[k]);
            bound(k);
        }
        for (std::size_t k = 0; k < count_; ++k)
            if (beta_[k] != 0) {
                const float* row = kernel_row(k);
                for (std::size_t t = 0; t < count_; ++t)
                    gradient_[t] -= beta_[k] * double{row[t]};
            }
    }
    /// Resizes the arrays for the active samples. The padding after them may not move.
    void resize() {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const std::size_t n = active_.size(), whole = kernels::padded_size<double>(n);
        gradient_.resize(whole);
        diagonal_.resize(whole);
        up_.resize(whole);
        low_.resize(whole);
        std::fill(gradient_.begin() + static_cast<std::ptrdiff_t>(n), gradient_.end(), 0.0);
        std::fill(diagonal_.begin() + static_cast<std::ptrdiff_t>(n), diagonal_.end(), 1.0);
        std::fill(up_.begin() + static_cast<std::ptrdiff_t>(n), up_.end(), -infinity);
        std::fill(low_.begin() + static_cast<std::ptrdiff_t>(n), low_.end(), infinity);
        selected_.clear();
        for (const std::size_t k : active_)
            selected_.push_back(problem_.samples[k]);
        rows_.select(selected_);
    }
    [[nodiscard]] double lowest_falling() const {
        double lowest = std::numeric_limits<double>::infinity();
        for (std::size_t t = 0; t < active_.size(); ++t)
            lowest = std::min(lowest, gradient_[t] + low_[t]);
        return lowest;
    }
    /// Leaves out samples at a bound whose gradient keeps them there. Returns whether there were any.
    bool shrink(double highest_rising) {
        const double lowest = lowest_falling();
        if (!(highest_rising - lowest > options_.tolerance))
            return false; // all are settled
        std::vector<std::size_t> kept;
        for (std::size_t t = 0; t < active_.size(); ++t) {
            const bool settled =
                (up_[t] != 0 && gradient_[t] > highest_rising) || (low_[t] != 0 && gradient_[t] < lowest);
            if (!settled)
                kept.push_back(t);
        }
        if (kept.size() == active_.size())
            return false;
        for (std::size_t k = 0; k < kept.size(); ++k) {
            const std::size_t t = kept[k];
            active_[k] = active_[t];
            gradient_[k] = gradient_[t];
            diagonal_[k] = diagonal_[t];
            up_[k] = up_[t];
            low_[k] = low_[t];
        }
        active_.resize(kept.size());
        resize();
        cache_.keep(kept, active_);
        return true;
    }

    binary_solution finish(solver_report report, double highest_rising) const {
        binary_solution result;
        result.coefficients.assign(beta_.begin(), beta_.end());
        double sum = 0, objective = 0;
        std::size_t between = 0;
        for (std::size_t k = 0; k < count_; ++k) {
            objective -= beta_[k] * (gradient_[k] + problem_.sides[k]) / 2;
            if (up_[k] == 0 && low_[k] == 0) {
                sum += gradient_[k];
                ++between;
            }
        }
        // On the margin the gradient is the offset itself; with none there, the middle of what is allowed.
        result.offset =
            between > 0 ? sum / static_cast<double>(between) : (highest_rising + lowest_falling()) / 2;
        report.objective = objective;
        result.report = report;
        return result;
    }

    const binary_problem& problem_;
    Rows& rows_;
    solver_options options_;
    std::size_t count_;
    std::vector<double> beta_;
    kernel_cache cache_;
    std::vector<std::size_t> active_, selected_; // positions in the problem, and their samples
    aligned_vector<double> gradient_, diagonal_, up_, low_;
};

}} // namespace tactnet
