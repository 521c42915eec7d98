#include "samples.hpp"

#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/solvers/sequential_minimal_optimisation.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

using namespace tactnet;

namespace {

/// The whole kernel matrix in double.
std::vector<double> kernel_matrix(feature_rows<> rows, double gamma) {
    const std::size_t n = rows.size();
    std::vector<double> matrix(n * n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            double squares = 0;
            for (std::size_t f = 0; f < rows.features(); ++f) {
                const double d = static_cast<double>(rows.row(i)[f]) - static_cast<double>(rows.row(j)[f]);
                squares += d * d;
            }
            matrix[i * n + j] = std::exp(-gamma * squares);
        }
    return matrix;
}

struct optimality {
    double violation = 0, objective = 0, sum = 0;
    double offset_error = 0; ///< how far the offset is from what the gradients allow
    bool within_bounds = true;
};

/// The conditions of Karush, Kuhn and Tucker of a problem over all samples, in double.
optimality conditions(const binary_problem& problem, const binary_solution& solution,
                      const std::vector<double>& kernel) {
    const std::size_t n = problem.samples.size();
    double highest = -1e300, lowest = 1e300;
    optimality result;
    for (std::size_t i = 0; i < n; ++i) {
        const double beta = solution.coefficients[i], side = problem.sides[i];
        double product = 0;
        for (std::size_t j = 0; j < n; ++j)
            product += kernel[i * n + j] * solution.coefficients[j];
        const double gradient = side - product, alpha = side * beta;
        result.objective += beta * product / 2 - side * beta;
        result.sum += beta;
        result.within_bounds = result.within_bounds && alpha >= 0 && alpha <= problem.costs[i];
        if (side > 0 ? alpha < problem.costs[i] : alpha > 0)
            highest = std::max(highest, gradient);
        if (side > 0 ? alpha > 0 : alpha < problem.costs[i])
            lowest = std::min(lowest, gradient);
    }
    result.violation = std::max(highest - lowest, 0.0);
    result.offset_error = std::max({highest - solution.offset, solution.offset - lowest, 0.0});
    return result;
}

binary_problem two_sides(const support::samples& s, double cost) {
    binary_problem problem{all_samples(s.labels.size()), {}, {}};
    for (const std::size_t label : s.labels) {
        problem.sides.push_back(label == 0 ? 1 : -1);
        problem.costs.push_back(cost);
    }
    return problem;
}

template <class Kernel>
binary_solution solve_with(const Kernel& kernel, const support::samples& s, const binary_problem& problem,
                           const solver_options& options, bool stored = true) {
    thread_pool alone;
    measured_samples<Kernel> measured(s.rows(), stored ? std::size_t{1} << 30 : 0, alone);
    return kernel_samples<Kernel>(measured, kernel, std::move(measured.gram), alone).solve(problem, options);
}
binary_solution solve(const support::samples& s, const binary_problem& problem, double gamma,
                      const solver_options& options, bool stored = true) {
    return solve_with(rbf_kernel{gamma}, s, problem, options, stored);
}

} // namespace

TEST_CASE("sequential_minimal_optimisation: the conditions of optimality hold, from the smallest cost to the "
          "largest") {
    const support::samples s = support::blobs(300, 8, 2, 0.8);
    const std::vector<double> kernel = kernel_matrix(s.rows(), 0.2);
    for (const double cost : {1e-9, 1e-2, 1.0, 100.0}) {
        CAPTURE(cost);
        const binary_problem problem = two_sides(s, cost);
        const binary_solution solution = solve(s, problem, 0.2, {});
        const optimality o = conditions(problem, solution, kernel);
        CHECK(solution.report.converged);
        CHECK(o.within_bounds);
        CHECK(std::abs(o.sum) <= 1e-12 * cost * 300);
        // Kernel values are single precision: each shifts a gradient by up to its error times its cost.
        const double rounding = 300 * cost * 0x1p-20;
        CHECK(o.violation <= 1e-3 + rounding);
        CHECK(o.offset_error <= 1e-3 + rounding);
        CHECK(solution.report.objective == doctest::Approx(o.objective).epsilon(1e-4));
    }
}

TEST_CASE("sequential_minimal_optimisation: the linear kernel too, on features as large as counts") {
    support::samples s = support::blobs(200, 12, 2, 0.8);
    for (float& value : s.values)
        value = std::floor(value * 100);
    std::vector<double> kernel(200 * 200);
    double largest = 0;
    for (std::size_t i = 0; i < 200; ++i)
        for (std::size_t j = 0; j < 200; ++j) {
            for (std::size_t f = 0; f < 12; ++f)
                kernel[i * 200 + j] +=
                    static_cast<double>(s.rows().row(i)[f]) * static_cast<double>(s.rows().row(j)[f]);
            largest = std::max(largest, kernel[i * 200 + j]);
        }
    const binary_problem problem = two_sides(s, 1e-5);
    for (const bool stored : {true, false}) {
        const binary_solution solution = solve_with(linear_kernel{}, s, problem, {}, stored);
        const optimality o = conditions(problem, solution, kernel);
        CHECK(solution.report.converged);
        CHECK(o.within_bounds);
        // Whole numbers: products below 2²⁴ are exact.
        REQUIRE(largest < 0x1p24);
        CHECK(o.violation <= 1e-3 + 1e-9);
        CHECK(solution.report.objective == doctest::Approx(o.objective).epsilon(1e-9));
    }
}

TEST_CASE("sequential_minimal_optimisation: shrinking, a small cache and rows found one by one lead to the "
          "same optimum") {
    const support::samples s = support::blobs(1200, 6, 2, 1.0);
    const binary_problem problem = two_sides(s, 10);
    const std::vector<double> kernel = kernel_matrix(s.rows(), 0.3);
    solver_options plain{.tolerance = 1e-4, .shrinking = false};
    const binary_solution reference = solve(s, problem, 0.3, plain);
    REQUIRE(reference.report.converged);
    REQUIRE(reference.report.iterations > 2000); // else nothing was shrunk
    for (const bool stored : {true, false})
        for (const std::size_t bytes : {std::size_t{0}, std::size_t{100'000}, std::size_t{1} << 28}) {
            const solver_options options{.tolerance = 1e-4, .cache_bytes = bytes};
            const binary_solution solution = solve(s, problem, 0.3, options, stored);
            CAPTURE(stored);
            CAPTURE(bytes);
            CHECK(solution.report.converged);
            CHECK(conditions(problem, solution, kernel).violation <= 1e-4 + 1200 * 10 * 0x1p-22);
            CHECK(solution.report.objective == doctest::Approx(reference.report.objective).epsilon(1e-5));
            CHECK(solution.offset == doctest::Approx(reference.offset).epsilon(1e-3));
        }
    CHECK(solve(s, problem, 0.3, {}, true).coefficients == solve(s, problem, 0.3, {}, false).coefficients);
}

TEST_CASE("sequential_minimal_optimisation: two points are separated half way") {
    const support::samples s{1, {-1, 3}, {0, 1}};
    const binary_solution solution = solve(s, two_sides(s, 100), 0.05, {});
    const double k = std::exp(-0.05 * 16);
    CHECK(solution.report.converged);
    CHECK(solution.coefficients[0] == doctest::Approx(1 / (1 - k)).epsilon(1e-6));
    CHECK(solution.coefficients[1] == -solution.coefficients[0]);
    CHECK(solution.offset == doctest::Approx(0).epsilon(1e-6));
}

TEST_CASE(
    "sequential_minimal_optimisation: duplicates with different labels: both at their cost, whatever it is") {
    for (const double cost : {1e-9, 1.0, 1e9}) {
        const support::samples s{2, {1, 2, 1, 2, 5, 6, 9, 1}, {0, 1, 0, 1}};
        const binary_solution solution = solve(s, two_sides(s, cost), 0.5, {});
        CAPTURE(cost);
        CHECK(solution.report.converged);
        CHECK(solution.coefficients[0] == cost);
        CHECK(solution.coefficients[1] == -cost);
        CHECK(std::isfinite(solution.offset));
    }
}

TEST_CASE(
    "sequential_minimal_optimisation: the limit of iterations is reported, and what was reached is usable") {
    const support::samples s = support::blobs(200, 4, 2, 0.5);
    const binary_problem problem = two_sides(s, 10);
    const binary_solution solution = solve(s, problem, 0.5, {.iteration_limit = 20});
    CHECK_FALSE(solution.report.converged);
    CHECK(solution.report.iterations == 20);
    CHECK(solution.report.violation > 1e-3);
    CHECK(solution.report.objective < 0);
    CHECK(conditions(problem, solution, kernel_matrix(s.rows(), 0.5)).within_bounds);
    CHECK(solve(s, problem, 0.5, {}).report.objective < solution.report.objective);
}

TEST_CASE(
    "sequential_minimal_optimisation: gamma of nothing makes all samples one, a huge gamma keeps all apart") {
    const support::samples s = support::blobs(50, 3, 2, 1.0);
    const binary_problem problem = two_sides(s, 2);
    const binary_solution same = solve(s, problem, 0, {});
    CHECK(same.report.converged);
    for (const double c : same.coefficients)
        CHECK(std::abs(c) == 2); // as many on both sides: all at their cost
    for (const double gamma : {1e10, 1e300}) {
        const binary_solution apart = solve(s, problem, gamma, {});
        CHECK(apart.report.converged);
        for (const double c : apart.coefficients)
            CHECK(std::abs(c) == doctest::Approx(1).epsilon(1e-3)); // K is the identity
    }
}
