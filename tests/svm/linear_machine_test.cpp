#include "samples.hpp"

#include <tactnet/svm/linear_machine.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

struct problem {
    biased_rows rows;
    std::vector<double> sides, costs;
};
problem first_against_rest(const support::samples& s, double cost, double bias = 1) {
    problem p{{s.rows(), bias}, {}, std::vector<double>(s.labels.size(), cost)};
    for (const std::size_t label : s.labels)
        p.sides.push_back(label == 0 ? 1 : -1);
    return p;
}

/// The primal objective, and the largest violation of the dual's conditions, in double.
struct optimality {
    double primal = 0, violation = 0;
};
optimality conditions(const problem& p, const descent_solution& solution, linear_loss loss) {
    const bool squared = loss == linear_loss::squared_hinge;
    optimality o;
    for (const double w : solution.weights)
        o.primal += w * w / 2;
    for (std::size_t i = 0; i < p.rows.size(); ++i) {
        double value = 0;
        for (std::size_t f = 0; f < p.rows.stride(); ++f)
            value += solution.weights[f] * static_cast<double>(p.rows.row(i)[f]);
        const double error = std::max(0.0, 1 - p.sides[i] * value), alpha = solution.coefficients[i];
        o.primal += p.costs[i] * (squared ? error * error : error);
        const double g = p.sides[i] * value - 1 + (squared ? alpha / (2 * p.costs[i]) : 0);
        const double highest = squared ? std::numeric_limits<double>::infinity() : p.costs[i];
        CHECK(alpha >= 0);
        CHECK(alpha <= highest);
        const double projected = alpha == 0 ? std::min(g, 0.0) : (alpha == highest ? std::max(g, 0.0) : g);
        o.violation = std::max(o.violation, std::abs(projected));
    }
    return o;
}

auto train(const support::samples& s, const linear_training_options& options, std::size_t threads = 1) {
    thread_pool pool(threads);
    return train_linear_machine(s.rows(), s.labels, options, pool);
}
double accuracy(const linear_machine<>& machine, const support::samples& s) {
    const std::vector<std::size_t> found = machine.predict(s.rows());
    std::size_t right = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
        right += found[i] == s.labels[i] ? 1 : 0;
    return static_cast<double>(right) / static_cast<double>(found.size());
}

} // namespace

TEST_CASE("linear_machine: at the optimum the duality gap closes and the dual's conditions hold") {
    const support::samples s = support::blobs(400, 20, 2, 1.5);
    for (const linear_loss loss : {linear_loss::hinge, linear_loss::squared_hinge})
        for (const double cost : {1e-3, 0.1, 1.0}) {
            const problem p = first_against_rest(s, cost);
            const descent_options options{.loss = loss, .tolerance = 1e-4, .iteration_limit = 100'000};
            const descent_solution solution =
                coordinate_descent(p.rows, p.sides, p.costs, options, 0).solve();
            const optimality o = conditions(p, solution, loss);
            CAPTURE(cost);
            CHECK(solution.report.converged);
            CHECK(o.violation <= 1e-3);
            CHECK(-solution.report.objective == doctest::Approx(o.primal).epsilon(1e-4));
            CHECK(-solution.report.objective <= o.primal * (1 + 1e-12));
        }
}

TEST_CASE("linear_machine: both losses separate clouds, with and without offset and standardisation") {
    const support::samples s = support::blobs(300, 30, 5, 0.4), fresh = support::blobs(500, 30, 5, 0.4);
    for (const linear_loss loss : {linear_loss::hinge, linear_loss::squared_hinge})
        for (const bool standardise : {false, true})
            for (const double bias : {0.0, 1.0}) {
                linear_training_options options{.bias = bias, .standardise = standardise};
                options.solver.loss = loss;
                const auto result = train(s, options);
                CHECK(result.converged());
                CHECK(accuracy(result.machine, fresh) > 0.95);
                CHECK((result.machine.parameters().offsets[0] == 0) == (bias == 0));
            }
}

TEST_CASE("linear_machine: the offset is the weight of the constant feature times that feature") {
    const support::samples s = support::blobs(100, 5, 2, 0.5);
    for (const double bias : {0.5, 10.0}) {
        const problem p = first_against_rest(s, 1, bias);
        const descent_solution solution = coordinate_descent(p.rows, p.sides, p.costs, {}, 0).solve();
        CHECK(train(s, {.bias = bias}).machine.parameters().offsets[0] == solution.weights[5] * bias);
    }
}

TEST_CASE("linear_machine: the constant feature is 1 where nothing is said of it") {
    const support::samples s = support::blobs(60, 3, 2, 0.5);
    const auto offsets = [&](const linear_training_options& options) {
        return train(s, options).machine.parameters().offsets;
    };
    CHECK(offsets({}) == offsets({.bias = 1}));
    CHECK(offsets({}) != offsets({.bias = 2}));
}

TEST_CASE("linear_machine: a class weight moves the border towards the others") {
    const support::samples s = support::blobs(400, 2, 2, 1.5);
    const auto of_first = [&](double weight) {
        linear_training_options options;
        options.class_weights = {{0, weight}};
        const std::vector<std::size_t> found = train(s, options).machine.predict(s.rows());
        return std::count(found.begin(), found.end(), std::size_t{0});
    };
    CHECK(of_first(0.1) < of_first(1));
    CHECK(of_first(1) < of_first(10));
    CHECK_THROWS_AS((void)of_first(0), std::invalid_argument);
}

TEST_CASE("linear_machine: decision values are weights times features plus offset") {
    const support::samples s = support::blobs(90, 7, 3, 0.5);
    const auto machine = train(s, {}).machine;
    const auto& parts = machine.parameters();
    const std::vector<double> found = machine.decision_values(s.rows());
    for (std::size_t i = 0; i < 90; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            double value = parts.offsets[c], size = 0;
            for (std::size_t f = 0; f < 7; ++f) {
                const double term =
                    static_cast<double>(s.values[7 * i + f]) * static_cast<double>(parts.weights[7 * c + f]);
                value += term;
                size += std::abs(term);
            }
            CHECK(std::abs(found[3 * i + c] - value) <= 8 * 0x1p-24 * size);
        }
}

TEST_CASE("linear_machine: the same bits on any number of threads, alone and in a batch") {
    const support::samples s = support::blobs(200, 33, 4, 1);
    const auto one = train(s, {}).machine, three = train(s, {}, 3).machine;
    CHECK(one.parameters().weights == three.parameters().weights);
    CHECK(one.parameters().offsets == three.parameters().offsets);
    const std::vector<double> batch = one.decision_values(s.rows());
    const feature_rows<33> rows(s.values);
    const linear_machine<33> fixed(one.parameters());
    for (std::size_t i = 0; i < 200; ++i) {
        const std::vector<double> single = one.decision_values({s.rows().row(i), 33});
        CHECK(std::equal(single.begin(), single.end(), batch.begin() + static_cast<std::ptrdiff_t>(4 * i)));
    }
    CHECK(fixed.decision_values(rows) == batch);
    CHECK(fixed.predict(rows.row(5)) == fixed.predict(rows)[5]);
}

TEST_CASE(
    "linear_machine: hard cases: scales of 1e±15, extreme costs, duplicates, two points, rows of zeros") {
    const support::samples s = support::blobs(150, 8, 3, 0.3);
    for (const float scale : {1e-15F, 1e15F}) {
        support::samples scaled = s;
        for (float& value : scaled.values)
            value *= scale;
        CHECK(accuracy(train(scaled, {.standardise = true}).machine, scaled) > 0.9);
        for (const double value : train(scaled, {}).machine.decision_values(scaled.rows()))
            REQUIRE(std::isfinite(value));
    }
    for (const linear_loss loss : {linear_loss::hinge, linear_loss::squared_hinge})
        for (const double cost : {1e-9, 1e9}) {
            linear_training_options options{.cost = cost};
            options.solver.loss = loss;
            const auto result = train(s, options);
            for (const double value : result.machine.decision_values(s.rows()))
                REQUIRE(std::isfinite(value));
            const support::samples both{2, {1, 1, 1, 1, 0, 0, 0, 0}, {0, 1, 0, 1}};
            const auto duplicates = train(both, options);
            for (const double value : duplicates.machine.decision_values(both.rows()))
                REQUIRE(std::isfinite(value));
            const support::samples zeros{1, {0, 0}, {0, 1}};
            linear_training_options no_bias = options;
            no_bias.bias = 0;
            for (const double value : train(zeros, no_bias).machine.decision_values(zeros.rows()))
                REQUIRE(value == 0);
        }
    const support::samples two{1, {-1, 1}, {5, 9}};
    CHECK(accuracy(train(two, {.cost = 10}).machine, two) == 1);
}

TEST_CASE("linear_machine: the limit of passes is reported, and what was reached is usable") {
    const support::samples s = support::blobs(300, 8, 3, 1);
    linear_training_options options{.cost = 100};
    options.solver.tolerance = 1e-9;
    options.solver.iteration_limit = 3;
    const auto result = train(s, options);
    CHECK_FALSE(result.converged());
    CHECK(result.reports[0].iterations == 3);
    CHECK(result.reports[0].violation > 1e-9);
    CHECK(accuracy(result.machine, s) > 0.4);
}

TEST_CASE("linear_machine: samples that cannot be learnt from are refused in words") {
    support::samples s = support::blobs(20, 3, 2, 1);
    s.values[3 * 11 + 1] = -std::numeric_limits<float>::infinity();
    CHECK_THROWS_WITH_AS((void)train(s, {}),
                         "features: row 11, column 1: expected a finite number, found -inf",
                         std::invalid_argument);
    s.values[3 * 11 + 1] = 0;
    std::fill(s.labels.begin(), s.labels.end(), std::size_t{4});
    CHECK_THROWS_WITH_AS((void)train(s, {}), "labels: expected two classes or more, found only class 4",
                         std::invalid_argument);
    const auto machine = train(support::blobs(20, 3, 2, 1), {}).machine;
    const std::vector<float> broken{1, std::numeric_limits<float>::quiet_NaN(), 1};
    CHECK_THROWS_WITH_AS((void)machine.predict(feature_rows<>(broken, 3)),
                         "features: row 0, column 1: expected a finite number, found nan",
                         std::invalid_argument);
    CHECK_THROWS_WITH_AS((void)machine.predict(feature_rows<>(broken, 1)),
                         "linear machine: expected rows of 3 features, found 1", std::invalid_argument);
}

TEST_CASE("linear_machine: options without a meaning are refused in words") {
    const support::samples s = support::blobs(20, 3, 2, 1);
    const auto error = [&](const linear_training_options& options) {
        return support::error_of([&] { (void)train(s, options); });
    };
    for (const double tolerance :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        CHECK(error({.solver = {.tolerance = tolerance}})
                  .starts_with("tolerance: expected a finite number above 0"));
    CHECK(error({.solver = {.tolerance = 1e-300, .iteration_limit = 3}}).empty());
    CHECK(error({.class_weights = {{2, 1.0}}}) == "class weights: expected labels of the samples, found 2");
    CHECK(error({.class_weights = {{0, 1.0}, {1, 2.0}, {0, 3.0}}}) ==
          "class weights: expected one for each label, found two for 0");
    CHECK(error({.class_weights = {{1, 1.0}, {0, 2.0}}}).empty());
}

TEST_CASE("linear_machine: features whose steps single precision does not hold are reported") {
    for (const float scale : {1.0f, 1e6f, 1e12f, 1e18f, 1e20f, 1e22f, 1e25f, 1e30f, 1e37f}) {
        CAPTURE(scale);
        support::samples s = support::blobs(60, 3, 2, 0.1);
        for (float& value : s.values)
            value *= scale;
        const auto result = train(s, {});
        CHECK(result.converged() == (scale < 1e21f));
        if (result.converged())
            CHECK(accuracy(result.machine, s) == 1);
        // What is to be done about large ones.
        const auto standardised = train(s, {.standardise = true});
        CHECK(standardised.converged());
        CHECK(accuracy(standardised.machine, s) == 1);
    }
}

TEST_CASE("linear_machine: one that has been moved from says so") {
    const support::samples s = support::blobs(20, 3, 2, 1);
    auto machine = train(s, {}).machine;
    const auto taken = std::move(machine);
    CHECK(taken.predict(s.rows()).size() == 20);
    CHECK_THROWS_WITH_AS((void)machine.predict(s.rows()), "linear machine: it has been moved from",
                         std::logic_error);
}

TEST_CASE("linear_machine: parameters that do not fit each other are refused") {
    const auto good = train(support::blobs(20, 3, 2, 1), {.standardise = true}).machine.parameters();
    const auto refused = [&](auto&& change) {
        auto parts = good;
        change(parts);
        CHECK_THROWS_AS(linear_machine<>{parts}, std::invalid_argument);
    };
    refused([](auto& p) { p.weights.pop_back(); });
    refused([](auto& p) { p.offsets.pop_back(); });
    refused([](auto& p) { p.labels[1] = p.labels[0]; });
    refused([](auto& p) { p.standardise->mean.pop_back(); });
    refused([](auto& p) { p.standardise->deviation.pop_back(); });
    CHECK_THROWS_AS(linear_machine<4>{good}, std::invalid_argument);
}

TEST_CASE("linear_machine: labels of many rows take blocks of memory, and are those of the values") {
    constexpr std::size_t classes = 500, rows = 20'000;
    linear_machine_parameters parts;
    parts.features = 2;
    parts.offsets.resize(classes);
    for (std::size_t c = 0; c < classes; ++c) {
        parts.labels.push_back(c);
        const auto angle = static_cast<double>(c);
        parts.weights.insert(parts.weights.end(),
                             {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))});
    }
    parts.standardise = standardisation{{0.5F, -0.25F}, {2, 3}};
    const linear_machine<> machine(parts);
    std::vector<float> values;
    for (std::size_t i = 0; i < rows; ++i)
        values.insert(values.end(), {static_cast<float>(i % 101) - 50, static_cast<float>(i % 89) - 40});
    const feature_rows<> all(values, 2);
    const std::size_t before = support::bytes_allocated();
    const std::vector<std::size_t> labels = machine.predict(all);
    const std::size_t predicting = support::bytes_allocated() - before;
    const std::vector<double> decisions = machine.decision_values(all);
    CHECK(predicting < (support::bytes_allocated() - before) / 2);
    bool same = labels.size() == rows && decisions.size() == rows * classes;
    for (std::size_t i = 0; same && i < rows; ++i) {
        const auto own = std::span(decisions).subspan(i * classes, classes);
        const std::vector<double> alone =
            machine.decision_values(feature_rows<>(std::span(values).subspan(2 * i, 2), 2));
        same = std::equal(own.begin(), own.end(), alone.begin(), alone.end()) &&
               labels[i] == winning_class(own, classes, multiclass::one_versus_rest);
    }
    CHECK(same);
}
