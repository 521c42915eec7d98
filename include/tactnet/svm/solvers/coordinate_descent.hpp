#pragma once

#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

// Dual coordinate descent for linear machines (Hsieh, Chang, Lin, Keerthi, Sundararajan, "A dual coordinate
// descent method for large-scale linear SVM", ICML 2008): one sample at a time, in random order, with
// shrinking.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The loss of a linear machine.
enum class linear_loss {
    hinge,        ///< max(0, 1 − y f(x))
    squared_hinge ///< its square
};

/// Rows in aligned memory, with a constant feature after the others for the offset.
class biased_rows {
public:
    biased_rows(feature_rows<> rows, double bias)
        : count_(rows.size()), stride_(pad_to_cache_line(rows.features() + 1)), values_(count_ * stride_) {
        for (std::size_t i = 0; i < count_; ++i) {
            std::copy_n(rows.row(i).begin(), rows.features(), values_.data() + i * stride_);
            values_[i * stride_ + rows.features()] = static_cast<float>(bias);
            const float* own = row(i);
            norms_.push_back(std::accumulate(own, own + stride_, 0.0, [](double sum, float value) {
                return sum + double{value} * double{value};
            }));
        }
    }
    [[nodiscard]] std::size_t size() const { return count_; }
    [[nodiscard]] std::size_t stride() const { return stride_; }
    [[nodiscard]] const float* row(std::size_t index) const { return values_.data() + index * stride_; }
    /// ‖·‖² of a row.
    [[nodiscard]] double norm(std::size_t index) const { return norms_[index]; }

private:
    std::size_t count_, stride_;
    aligned_vector<float> values_;
    std::vector<double> norms_;
};

/// Options of coordinate descent.
struct descent_options {
    linear_loss loss = linear_loss::squared_hinge;
    /// Largest difference of projected gradients. LIBLINEAR's is 0.1, with which 0.7 % of the answers on raw
    /// pixels differ from those of the optimum; with this one 0.05 %.
    double tolerance = 0.01;
    std::size_t iteration_limit = 1000; ///< passes over the samples
    std::uint64_t seed = 1;             ///< of the order of the samples
};

/// Weights, offset and outcome of coordinate descent.
struct descent_solution {
    std::vector<double> weights;      ///< of the features, and of the constant one
    std::vector<double> coefficients; ///< α of each sample
    solver_report report;
};

/// Trains one machine. `sides` are +1 or −1, `costs` those of an error on each sample.
class coordinate_descent {
public:
    coordinate_descent(const biased_rows& rows, std::span<const double> sides, std::span<const double> costs,
                       const descent_options& options, std::uint32_t machine)
        : rows_(rows),
          sides_(sides),
          costs_(costs),
          options_(options),
          machine_(machine),
          alpha_(rows.size()),
          weights_(rows.stride()) {}

    [[nodiscard]] descent_solution solve() {
        std::vector<std::size_t> active(rows_.size());
        std::iota(active.begin(), active.end(), std::size_t{0});
        solver_report report;
        gradient_range before;
        while (report.iterations < options_.iteration_limit) {
            random_stream(options_.seed, random_purposes::order, machine_,
                          static_cast<std::uint32_t>(report.iterations))
                .shuffle(active);
            ++report.iterations;
            underflows_ = false;
            const gradient_range range = pass(active, before);
            report.violation = std::max(range.highest - range.lowest, 0.0);
            before = range;
            if (report.violation <= options_.tolerance) {
                if (active.size() == rows_.size()) {
                    report.converged = !underflows_;
                    break;
                }
                // Checks all samples once more before the result is accepted.
                active.resize(rows_.size());
                std::iota(active.begin(), active.end(), std::size_t{0});
                before = {};
            }
        }
        return finish(report);
    }

private:
    static constexpr double infinity = std::numeric_limits<double>::infinity();

    /// Projected gradients seen in a pass.
    struct gradient_range {
        double highest = -infinity, lowest = infinity;

        /// Samples at 0 with a gradient above this are settled, or at their cost with one below.
        [[nodiscard]] double upper() const { return highest > 0 ? highest : infinity; }
        [[nodiscard]] double lower() const { return lowest < 0 ? lowest : -infinity; }
        void include(double value) {
            highest = std::max(highest, value);
            lowest = std::min(lowest, value);
        }
    };

    [[nodiscard]] bool squared() const { return options_.loss == linear_loss::squared_hinge; }
    [[nodiscard]] double highest_alpha(std::size_t i) const { return squared() ? infinity : costs_[i]; }
    [[nodiscard]] double ridge(std::size_t i) const { return squared() ? 0.5 / costs_[i] : 0.0; }

    /// Takes one step per active sample, and removes settled samples.
    gradient_range pass(std::vector<std::size_t>& active, const gradient_range& before) {
        gradient_range range;
        for (std::size_t k = 0; k < active.size();) {
            const std::size_t i = active[k];
            const double g = sides_[i] * kernels::dot(weights_.data(), rows_.row(i), rows_.stride()) - 1 +
                             ridge(i) * alpha_[i];
            const bool at_zero = alpha_[i] == 0, at_cost = alpha_[i] == highest_alpha(i);
            if ((at_zero && g > before.upper()) || (at_cost && g < before.lower())) {
                std::swap(active[k], active.back());
                active.pop_back();
                continue;
            }
            const double projected = at_zero ? std::min(g, 0.0) : (at_cost ? std::max(g, 0.0) : g);
            range.include(projected);
            if (std::abs(projected) > least_gradient)
                step(i, g);
            ++k;
        }
        return range;
    }
    void step(std::size_t i, double g) {
        const double old = alpha_[i];
        // A sample of zeros has no curvature: its bound is the answer.
        const double curvature = std::max(rows_.norm(i) + ridge(i), std::numeric_limits<double>::min());
        alpha_[i] = std::clamp(old - g / curvature, 0.0, highest_alpha(i));
        const auto change = static_cast<float>((alpha_[i] - old) * sides_[i]);
        // Of large features, steps of α are too small for single precision: then no weight moves.
        underflows_ = underflows_ || (std::abs(g) > options_.tolerance && alpha_[i] != old &&
                                      std::abs(change) < std::numeric_limits<float>::min());
        kernels::add_multiple(weights_.data(), change, rows_.row(i), rows_.stride());
    }
    [[nodiscard]] descent_solution finish(solver_report report) {
        // Recomputed from the coefficients, free of accumulated rounding errors.
        descent_solution result{std::vector<double>(rows_.stride()), alpha_, report};
        double linear = 0;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            linear += alpha_[i] * (ridge(i) * alpha_[i] / 2 - 1);
            if (alpha_[i] != 0)
                for (std::size_t f = 0; f < rows_.stride(); ++f)
                    result.weights[f] += alpha_[i] * sides_[i] * double{rows_.row(i)[f]};
        }
        result.report.objective =
            linear +
            std::inner_product(result.weights.begin(), result.weights.end(), result.weights.begin(), 0.0) / 2;
        return result;
    }

    static constexpr double least_gradient = 1e-12;

    const biased_rows& rows_;
    std::span<const double> sides_, costs_;
    descent_options options_;
    std::uint32_t machine_;
    std::vector<double> alpha_;
    aligned_vector<float> weights_;
    bool underflows_ = false; ///< a step of the pass was lost in single precision
};

}} // namespace tactnet
