// Support vector machines of two classes on samples that are hardly a problem. What is measured is the
// duality gap, which is zero at the optimum and nowhere else: βᵀKβ + C Σ max(0, 1 − y f) − Σ |β|, of kernels
// in double. A solver that ends with a violation of at most ε leaves at most n C ε; that its kernels are
// rounded adds 8 u (Σ |β|)².

#include "hold.hpp"

#include <tactnet/svm.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <support/tolerance.hpp>
#include <svm/samples.hpp>
#include <vector>

using namespace tactnet;
using hard_cases::hold;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

constexpr double u = support::unit_roundoff<float>;

/// exp(−γ ‖a − b‖²) in double.
double kernel(const support::samples& s, std::size_t a, std::size_t b, double gamma) {
    double sum = 0;
    for (std::size_t f = 0; f < s.features; ++f) {
        const double d = static_cast<double>(s.values[a * s.features + f]) -
                         static_cast<double>(s.values[b * s.features + f]);
        sum += d * d;
    }
    return std::exp(-gamma * sum);
}
double side(std::size_t label) {
    return label == 0 ? 1 : -1;
}

double gap(const support::samples& s, double cost, double gamma, const std::vector<double>& beta,
           double offset) {
    double squares = 0, errors = 0, linear = 0;
    for (std::size_t i = 0; i < s.labels.size(); ++i) {
        double value = 0;
        for (std::size_t j = 0; j < s.labels.size(); ++j)
            if (beta[j] != 0)
                value += beta[j] * kernel(s, i, j, gamma);
        squares += beta[i] * value;
        errors += std::max(0.0, 1 - side(s.labels[i]) * (value + offset));
        linear += std::abs(beta[i]);
    }
    return squares + cost * errors - linear;
}

void check_gap(const std::string& name, const support::samples& s, double cost, double gamma) {
    thread_pool threads(1);
    const auto trained = train_kernel_machine(
        s.rows(), s.labels, kernel_training_options<rbf_kernel>{.kernel = {gamma}, .cost = cost}, threads);
    CHECK(trained.converged());
    // Support vectors come by class and in order: each is the next sample of its class that is the same.
    const auto& parts = trained.machine.parameters();
    std::vector<double> beta(s.labels.size());
    std::size_t vector = 0;
    for (std::size_t label = 0; label < 2; ++label) {
        std::size_t sample = 0;
        for (std::size_t v = 0; v < parts.support_counts[label]; ++v, ++vector, ++sample) {
            while (s.labels[sample] != label ||
                   !std::equal(
                       parts.support_vectors.begin() + static_cast<std::ptrdiff_t>(vector * s.features),
                       parts.support_vectors.begin() + static_cast<std::ptrdiff_t>((vector + 1) * s.features),
                       s.values.begin() + static_cast<std::ptrdiff_t>(sample * s.features)))
                ++sample;
            beta[sample] = parts.coefficients[vector];
        }
    }
    double sum = 0;
    for (const double b : beta)
        sum += std::abs(b);
    const double count = static_cast<double>(s.labels.size());
    hold(name + ", duality gap", unit::absolute,
         {0, gap(s, cost, gamma, beta, parts.offsets[0]), count * cost * 1e-3 + 8 * u * sum * sum});
}

support::samples on_a_line(std::size_t count) {
    support::samples s{2, {}, {}};
    for (std::size_t i = 0; i < count; ++i) {
        const auto x = static_cast<float>(i) / 8;
        s.values.insert(s.values.end(), {x, 2 * x + 1});
        s.labels.push_back(i * 7 % count < count / 2 ? 0 : 1);
    }
    return s;
}

} // namespace

TEST_CASE("kernel_machine: the duality gap closes on degenerate samples") {
    check_gap("two points", {1, {-1, 1}, {0, 1}}, 1, 0.5);
    check_gap("40 points on a line", on_a_line(40), 1, 0.5);
    support::samples doubled{2, {}, {}}, contradicting{2, {}, {}}, rare = support::blobs(1000, 2, 1, 0.3);
    for (std::size_t i = 0; i < 100; ++i) {
        const auto x = static_cast<float>(i % 2), y = static_cast<float>(i / 2 % 2);
        doubled.values.insert(doubled.values.end(), {x, y}), doubled.labels.push_back(i % 2);
        contradicting.values.insert(contradicting.values.end(), {x, y}),
            contradicting.labels.push_back(i / 4 % 2);
    }
    check_gap("4 points, each 25 times", doubled, 1, 0.5);
    check_gap("4 points, each in both classes", contradicting, 1, 0.5);
    rare.values.insert(rare.values.end(), {0.2f, 0.1f}), rare.labels.push_back(1);
    check_gap("1 sample against 1000", rare, 1, 0.5);
}

TEST_CASE("kernel_machine: the duality gap closes at extreme costs and widths") {
    const support::samples s = support::blobs(60, 2, 2, 0.3);
    for (const double cost : {1e-12, 1e12})
        check_gap(cost < 1 ? "C 1e-12" : "C 1e12", s, cost, 50);
    for (const double gamma : {1e-12, 1e12})
        check_gap(gamma < 1 ? "γ 1e-12" : "γ 1e12", s, 1, gamma);
}

// Σ β K + b. Kernels are off by what the distance is: measured in double where it cancels, else by γ(n + 4)
// of 64 times itself, and x exp(−x) is 0.37 at most; an exponential by 2 units, a weight times it is summed
// in double.
TEST_CASE("kernel_machine: decision values of a cloud far from the origin") {
    support::samples far = support::blobs(80, 4, 2, 0.3);
    for (float& value : far.values)
        value += 3e4f;
    thread_pool threads(1);
    const auto machine = train_kernel_machine(far.rows(), far.labels,
                                              kernel_training_options<rbf_kernel>{.kernel = {0.5}}, threads)
                             .machine;
    const std::vector<double> values = machine.decision_values(far.rows(), threads);
    const auto& parts = machine.parameters();
    std::vector<outcome> all;
    for (std::size_t i = 0; i < far.labels.size(); ++i) {
        double exact = parts.offsets[0], sizes = 0;
        for (std::size_t v = 0; v < parts.coefficients.size(); ++v) {
            double distance = 0;
            for (std::size_t f = 0; f < 4; ++f) {
                const float x = far.values[i * 4 + f], y = parts.support_vectors[v * 4 + f];
                distance += std::pow(static_cast<double>(x) - static_cast<double>(y), 2);
            }
            exact += parts.coefficients[v] * std::exp(-0.5 * distance);
            sizes += std::abs(parts.coefficients[v]);
        }
        all.push_back({exact, values[i], sizes * (0.37 * 64 * support::accumulated(u, 8) + 8 * u)});
    }
    hold("decision values of a cluster at 3e4", unit::absolute, all);
}

TEST_CASE("kernel_machine: features of very different size, standardised") {
    support::samples s = support::blobs(90, 3, 3, 0.2);
    for (std::size_t i = 0; i < s.labels.size(); ++i)
        s.values[i * 3] *= 1e-12f, s.values[i * 3 + 2] *= 1e12f;
    thread_pool threads(1);
    const auto right = [&](bool standardise) {
        const auto machine =
            train_kernel_machine(
                s.rows(), s.labels,
                kernel_training_options<rbf_kernel>{.kernel = {0.3}, .standardise = standardise}, threads)
                .machine;
        const auto found = machine.predict(s.rows(), threads);
        double count = 0;
        for (std::size_t i = 0; i < found.size(); ++i)
            count += found[i] == s.labels[i] && i < 30 ? 1 : 0;
        const auto fresh = machine.decision_values(s.rows(), threads);
        return std::pair(count, std::ranges::all_of(fresh, [](double v) { return std::isfinite(v); }));
    };
    // At most 3 of the first 30 lie nearer to another centre.
    CHECK(right(true).second);
    CHECK(right(false).second);
    hold("features of 1e-12, 1 and 1e12: correct of 30", unit::absolute, {30, right(true).first, 3});
}

// The sum of all is 1 up to the k divisions of each iteration, of which there are 100.
TEST_CASE("couple_pairwise: pairs that are certain") {
    const std::size_t k = 5;
    std::vector<double> certain(k * k);
    for (std::size_t i = 0; i < k; ++i)
        for (std::size_t j = 0; j < k; ++j)
            certain[i * k + j] = i < j ? 1 : 0;
    const std::vector<double> p = couple_pairwise(certain, k);
    hold("pairwise probabilities of exactly 0 and 1: their sum", unit::relative,
         {1, std::accumulate(p.begin(), p.end(), 0.0), 100 * k * k * 0x1p-52});
    for (const double each : p)
        CHECK(each >= 0);
    CHECK(std::ranges::max_element(p) == p.begin());
}

// 1 / (1 + exp(z)) of both forms: 3 roundings and two units of an exponential.
TEST_CASE("sigmoid: separable values, and values of any size") {
    const std::vector<double> sides{1, 1, -1, -1}, values{800, 900, -800, -900};
    const platt_sigmoid fitted = fit_platt_sigmoid(values, sides);
    CHECK(std::isfinite(fitted.slope));
    // The optimum: by symmetry without an offset, where Σ v (target − p(v)) = 0. Newton's method ends where
    // this is below 1e-5; divided by its derivative, 4 · 850² · p (1 − p), and times 800 p (1 − p).
    double low = 0, high = 1;
    for (int i = 0; i < 200; ++i) {
        const double slope = (low + high) / 2;
        const auto p = [&](double v) { return 1 / (1 + std::exp(-slope * v)); };
        (800 * (0.75 - p(800)) + 900 * (0.75 - p(900)) > 0 ? low : high) = slope;
    }
    hold("sigmoid of separable values: P(first) at 800", unit::absolute,
         {1 / (1 + std::exp(-low * 800)), fitted.probability(800), 1e-5 * 800 / (4 * 800.0 * 800.0)});
    const platt_sigmoid steep{1, 0};
    CHECK(steep.probability(1000) == 0);
    hold("sigmoid of 700", unit::relative, {std::exp(-700.0), steep.probability(700), 5 * 0x1p-53});
}

namespace {

/// What a linear machine minimises, ½ ‖w‖² + ½ b² + C Σ max(0, 1 − y f)², of weights in double.
double objective(const support::samples& s, double cost, const std::vector<double>& weights, double offset) {
    double sum = offset * offset / 2;
    for (const double w : weights)
        sum += w * w / 2;
    for (std::size_t i = 0; i < s.labels.size(); ++i) {
        double value = offset;
        for (std::size_t f = 0; f < s.features; ++f)
            value += weights[f] * static_cast<double>(s.values[i * s.features + f]);
        sum += cost * std::pow(std::max(0.0, 1 - side(s.labels[i]) * value), 2);
    }
    return sum;
}

/// The optimum by Newton's method in long double: of samples that are inside their margin.
std::vector<double> optimum(const support::samples& s, double cost) {
    const std::size_t n = s.features + 1;
    std::vector<long double> w(n);
    for (int step = 0; step < 100; ++step) {
        std::vector<std::vector<long double>> a(n, std::vector<long double>(n + 1));
        for (std::size_t f = 0; f < n; ++f)
            a[f][f] = 1;
        for (std::size_t i = 0; i < s.labels.size(); ++i) {
            std::vector<long double> x(n, 1);
            long double value = 0;
            for (std::size_t f = 0; f + 1 < n; ++f)
                x[f] = s.values[i * s.features + f];
            for (std::size_t f = 0; f < n; ++f)
                value += w[f] * x[f];
            const long double y = side(s.labels[i]);
            for (std::size_t f = 0; y * value < 1 && f < n; ++f) {
                for (std::size_t g = 0; g < n; ++g)
                    a[f][g] += 2 * static_cast<long double>(cost) * x[f] * x[g];
                a[f][n] += 2 * static_cast<long double>(cost) * y * x[f];
            }
        }
        for (std::size_t k = 0; k < n; ++k)
            for (std::size_t f = 0; f < n; ++f)
                if (const long double factor = a[f][k] / a[k][k]; f != k)
                    for (std::size_t g = k; g <= n; ++g)
                        a[f][g] -= factor * a[k][g];
        for (std::size_t f = 0; f < n; ++f)
            w[f] = a[f][n] / a[f][f];
    }
    return {w.begin(), w.end()};
}

enum class end { at_optimum, may_be_out_of_passes };

/// The dual ends where projected gradients differ by at most ε: with α of the optimum that is a gap of at
/// most ε Σ (α + its own), where α = 2 C max(0, 1 − y f). Weights are rounded to single precision: their
/// share of the objective's slope, which is none at the optimum, and 2 u of each loss.
void check_linear(const std::string& name, const support::samples& s, double cost,
                  end ends = end::at_optimum) {
    thread_pool threads(1);
    linear_training_options options{.cost = cost};
    const auto trained = train_linear_machine(s.rows(), s.labels, options, threads);
    const auto& parts = trained.machine.parameters();
    const std::vector<double> exact = optimum(s, cost);
    const auto value = [&](std::vector<double> w) {
        const double offset = w.back();
        w.pop_back();
        return objective(s, cost, w, offset);
    };
    std::vector<double> ours(parts.weights.begin(),
                             parts.weights.begin() + static_cast<std::ptrdiff_t>(s.features));
    ours.push_back(parts.offsets[0]);
    // A thousand passes may not be enough.
    if (!trained.converged() && ends == end::may_be_out_of_passes)
        return;
    CHECK(trained.converged());
    double alphas = 0, rounding = 0;
    for (std::size_t i = 0; i < s.labels.size(); ++i) {
        double f = exact.back(), sizes = std::abs(exact.back());
        for (std::size_t k = 0; k < s.features; ++k) {
            const double term = exact[k] * static_cast<double>(s.values[i * s.features + k]);
            f += term, sizes += std::abs(term);
        }
        const double slack = std::max(0.0, 1 - side(s.labels[i]) * f);
        alphas += 2 * cost * slack;
        rounding += cost * (2 * slack * u * sizes + u * u * sizes * sizes);
    }
    hold("linear, " + name + ": objective", unit::absolute,
         {value(exact), value(ours), 2 * options.solver.tolerance * alphas + rounding});
}

} // namespace

TEST_CASE("linear_machine: the objective of degenerate samples and extreme costs") {
    const support::samples two{1, {-1, 1}, {0, 1}};
    check_linear("two points", two, 1);
    check_linear("two points, C 1e-12", two, 1e-12);
    check_linear("two points, C 1e6", two, 1e6);
    check_linear("40 points on a line", on_a_line(40), 1, end::may_be_out_of_passes);
    support::samples rare = support::blobs(1000, 2, 1, 0.3), uneven = support::blobs(60, 3, 2, 0.2);
    rare.values.insert(rare.values.end(), {0.2f, 0.1f}), rare.labels.push_back(1);
    check_linear("1 sample against 1000", rare, 1);
    for (std::size_t i = 0; i < uneven.labels.size(); ++i)
        uneven.values[i * 3] *= 1e-6f, uneven.values[i * 3 + 2] *= 1e3f;
    check_linear("features of 1e-6, 1 and 1000", uneven, 1);
}

// For contradicting samples at a cost of 1e12, a thousand passes find no machine, and the report says so.
TEST_CASE("linear_machine: a training that does not converge reports it") {
    support::samples both = on_a_line(40);
    thread_pool threads(1);
    const auto trained =
        train_linear_machine(both.rows(), both.labels, linear_training_options{.cost = 1e12}, threads);
    bool finite = true;
    for (const double value : trained.machine.decision_values(both.rows()))
        finite &= std::isfinite(value);
    CHECK(finite);
    CHECK(std::ranges::any_of(trained.reports, [](const solver_report& r) { return !r.converged; }));
}
