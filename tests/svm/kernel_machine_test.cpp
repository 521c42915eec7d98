#include "samples.hpp"

#include <tactnet/svm/kernel_training.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

template <class Kernel = rbf_kernel>
auto train(const support::samples& s, const kernel_training_options<Kernel>& options,
           std::size_t threads = 1) {
    thread_pool pool(threads);
    return train_kernel_machine(s.rows(), s.labels, options, pool);
}
template <class Machine>
double accuracy(const Machine& machine, const support::samples& s) {
    thread_pool alone;
    const std::vector<std::size_t> found = machine.predict(s.rows(), alone);
    std::size_t right = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
        right += found[i] == s.labels[i] ? 1 : 0;
    return static_cast<double>(right) / static_cast<double>(found.size());
}
template <class Machine>
bool same_machine(const Machine& a, const Machine& b) {
    const auto &p = a.parameters(), &q = b.parameters();
    const auto same_sigmoid = [](platt_sigmoid x, platt_sigmoid y) {
        return x.slope == y.slope && x.offset == y.offset;
    };
    return p.labels == q.labels && p.support_counts == q.support_counts &&
           p.support_vectors == q.support_vectors && p.coefficients == q.coefficients &&
           p.offsets == q.offsets && std::ranges::equal(p.sigmoids, q.sigmoids, same_sigmoid);
}

constexpr multiclass schemes[] = {multiclass::one_versus_one, multiclass::one_versus_rest};

} // namespace

TEST_CASE("kernel_machine: decision values are the sums that the parameters say, in double") {
    const support::samples s = support::blobs(120, 10, 4, 0.7);
    for (const multiclass scheme : schemes) {
        const auto result = train<rbf_kernel>(s, {.cost = 5, .scheme = scheme});
        const auto& parts = result.machine.parameters();
        thread_pool alone;
        const std::vector<double> found = result.machine.decision_values(s.rows(), alone);
        const std::size_t each = parts.coefficients_each(), machines = result.machine.machines();
        CHECK(result.converged());
        CHECK(machines == (scheme == multiclass::one_versus_one ? 6 : 4));
        std::vector<std::size_t> class_of;
        for (std::size_t c = 0; c < 4; ++c)
            class_of.insert(class_of.end(), parts.support_counts[c], c);
        const auto pairs = class_pairs(4);
        bool right = true;
        for (std::size_t i = 0; i < 120; ++i)
            for (std::size_t m = 0; m < machines; ++m) {
                double value = parts.offsets[m], size = std::abs(value);
                for (std::size_t v = 0; v < class_of.size(); ++v) {
                    std::size_t place = m;
                    if (scheme == multiclass::one_versus_one) {
                        const auto [a, b] = pairs[m];
                        if (class_of[v] != a && class_of[v] != b)
                            continue;
                        place = class_of[v] == a ? b - 1 : a;
                    }
                    double squares = 0;
                    for (std::size_t f = 0; f < 10; ++f)
                        squares += std::pow(static_cast<double>(s.values[i * 10 + f]) -
                                                static_cast<double>(parts.support_vectors[v * 10 + f]),
                                            2);
                    const double term =
                        parts.coefficients[v * each + place] * std::exp(-*parts.kernel.gamma * squares);
                    value += term;
                    size += std::abs(term);
                }
                // A kernel value goes through some 20 roundings, in units of exponents up to 10.
                right = right && std::abs(found[i * machines + m] - value) <= 200 * 0x1p-24 * size;
            }
        CHECK(right);
    }
}

TEST_CASE("kernel_machine: clouds are separated, by either kernel and scheme; features known when compiling "
          "or not") {
    const support::samples s = support::blobs(300, 12, 5, 0.3), fresh = support::blobs(600, 12, 5, 0.3);
    for (const multiclass scheme : schemes) {
        CHECK(accuracy(train<rbf_kernel>(s, {.cost = 10, .scheme = scheme}).machine, fresh) > 0.95);
        CHECK(accuracy(train<linear_kernel>(s, {.scheme = scheme}).machine, fresh) > 0.9);
    }
    thread_pool alone;
    const auto fixed = train_kernel_machine(feature_rows<12>(s.values), s.labels,
                                            kernel_training_options<rbf_kernel>{.cost = 10}, alone);
    const auto free = train<rbf_kernel>(s, {.cost = 10});
    const feature_rows<12> rows(fresh.values);
    CHECK(fixed.machine.decision_values(rows, alone) == free.machine.decision_values(rows, alone));
    CHECK(fixed.machine.predict(rows.row(3)) == fixed.machine.predict(rows, alone)[3]);
}

TEST_CASE("kernel_machine: the same bits on any number of threads, alone and in a batch, and in a copy") {
    const support::samples s = support::blobs(200, 12, 5, 0.8);
    for (const std::size_t bytes : {std::size_t{1} << 28, std::size_t{0}}) {
        kernel_training_options<rbf_kernel> options{.cost = 10, .probability_folds = 3};
        options.solver.cache_bytes = bytes;
        const auto one = train(s, options), three = train(s, options, 3);
        CHECK(same_machine(one.machine, three.machine));
        thread_pool pool(3), alone;
        const std::vector<double> batch = one.machine.probabilities(s.rows(), pool);
        CHECK(batch == one.machine.probabilities(s.rows(), alone));
        const auto copy = one.machine;
        bool same = true;
        for (std::size_t i = 0; i < s.labels.size(); ++i) {
            const std::vector<double> single = copy.probabilities({s.rows().row(i), 12}, alone);
            same = same && std::equal(single.begin(), single.end(),
                                      batch.begin() + static_cast<std::ptrdiff_t>(5 * i));
        }
        CHECK(same);
    }
}

TEST_CASE("kernel_machine: probabilities add up to one and are right about as often as they say") {
    const support::samples s = support::blobs(600, 4, 3, 0.7), fresh = support::blobs(3000, 4, 3, 0.7);
    thread_pool alone;
    for (const multiclass scheme : schemes) {
        const auto machine = train<rbf_kernel>(s, {.scheme = scheme, .probability_folds = 5}).machine;
        const std::vector<double> p = machine.probabilities(fresh.rows(), alone);
        double claimed = 0, right = 0;
        bool sums = true;
        for (std::size_t i = 0; i < fresh.labels.size(); ++i) {
            const auto row = std::span(p).subspan(3 * i, 3);
            sums = sums && std::abs(std::accumulate(row.begin(), row.end(), 0.0) - 1) < 1e-12;
            const auto best = std::max_element(row.begin(), row.end());
            claimed += *best / 3000;
            right += static_cast<std::size_t>(best - row.begin()) == fresh.labels[i] ? 1.0 / 3000 : 0;
        }
        CHECK(sums);
        // Three standard deviations of 3000 draws, and what 600 samples leave open.
        CHECK(std::abs(claimed - right) < 3 * 0.5 / std::sqrt(3000.0) + 3 * 0.5 / std::sqrt(600.0));
        CHECK(right > 0.6);
    }
    // Two classes are not coupled: the likelier one is still the one that is recognised.
    const support::samples pair = support::blobs(100, 4, 2, 0.1);
    for (const multiclass scheme : schemes) {
        const auto machine = train<rbf_kernel>(pair, {.scheme = scheme, .probability_folds = 5}).machine;
        const std::vector<double> p = machine.probabilities(pair.rows(), alone);
        for (std::size_t i = 0; i < pair.labels.size(); ++i) {
            CHECK(p[2 * i + pair.labels[i]] > 0.7);
            CHECK(p[2 * i] + p[2 * i + 1] == doctest::Approx(1));
        }
    }
    CHECK_THROWS_AS((void)train<rbf_kernel>(s, {.probability_folds = 1}), std::invalid_argument);
    CHECK_THROWS_AS((void)train<rbf_kernel>(s, {}).machine.probabilities(s.rows(), alone), std::logic_error);
}

TEST_CASE("kernel_machine: probabilities of samples that were learnt by heart are no higher than of others") {
    support::samples s = support::blobs(200, 4, 2, 1);
    random_stream random(5, random_purposes::order);
    for (std::size_t& label : s.labels)
        label = random.below(2); // nothing to be learnt
    thread_pool alone;
    const auto machine = train<rbf_kernel>(s, {.kernel = {10.0}, .cost = 10, .probability_folds = 5}).machine;
    REQUIRE(accuracy(machine, s) == 1);
    for (const double p : machine.probabilities(s.rows(), alone))
        CHECK(std::abs(p - 0.5) < 0.3);
}

TEST_CASE("kernel_machine: a class weight moves the border towards the others") {
    const support::samples s = support::blobs(400, 2, 2, 1.5);
    const auto of_first = [&](double weight) {
        kernel_training_options<rbf_kernel> options;
        options.class_weights = {{0, weight}};
        thread_pool alone;
        const auto found = train(s, options).machine.predict(s.rows(), alone);
        return std::count(found.begin(), found.end(), std::size_t{0});
    };
    CHECK(of_first(0.1) < of_first(1));
    CHECK(of_first(1) < of_first(10));
    CHECK_THROWS_AS((void)of_first(0), std::invalid_argument);
}

TEST_CASE("kernel_machine: labels are any numbers, and come back as they are") {
    support::samples s = support::blobs(60, 6, 3, 0.1);
    const std::size_t names[] = {1000, 7, 42};
    for (std::size_t& label : s.labels)
        label = names[label];
    const auto machine = train<rbf_kernel>(s, {}).machine;
    CHECK(machine.parameters().labels == std::vector<std::size_t>{7, 42, 1000});
    CHECK(accuracy(machine, s) == 1);
}

TEST_CASE("kernel_machine: hard cases: scales of 1e±15, constant features, extreme costs and gammas") {
    const support::samples s = support::blobs(150, 8, 3, 0.3);
    const double usual = accuracy(train<rbf_kernel>(s, {.cost = 10}).machine, s);
    CHECK(usual > 0.95);
    for (const float scale : {1e-15F, 1e15F}) {
        support::samples scaled = s;
        for (float& value : scaled.values)
            value *= scale;
        CHECK(std::abs(accuracy(train<rbf_kernel>(scaled, {.cost = 10}).machine, scaled) - usual) <= 0.01);
        CHECK(accuracy(train<rbf_kernel>(scaled, {.cost = 10, .standardise = true}).machine, scaled) > 0.95);
    }
    support::samples constant = s;
    for (std::size_t i = 0; i < 150; ++i)
        constant.values[8 * i + 3] = 1e7F + 1;
    CHECK(accuracy(train<rbf_kernel>(constant, {.kernel = {0.5}, .cost = 10}).machine, constant) > 0.9);
    CHECK(accuracy(train<rbf_kernel>(constant, {.cost = 10, .standardise = true}).machine, constant) > 0.9);
    support::samples all_constant = s;
    std::fill(all_constant.values.begin(), all_constant.values.end(), 2.0F);
    CHECK(accuracy(train<rbf_kernel>(all_constant, {.standardise = true}).machine, all_constant) ==
          doctest::Approx(1.0 / 3));
    for (const double cost : {1e-9, 1e9})
        for (const double gamma : {0.0, 1e-9, 1e9, 1e300}) {
            CAPTURE(cost);
            CAPTURE(gamma);
            kernel_training_options<rbf_kernel> options{.kernel = {gamma}, .cost = cost};
            options.solver.iteration_limit = 100'000;
            const auto result = train(s, options);
            thread_pool alone;
            for (const double value : result.machine.decision_values(s.rows(), alone))
                REQUIRE(std::isfinite(value));
            if (gamma >= 1e9 && cost == 1e9)
                CHECK(accuracy(result.machine, s) == 1);
        }
}

TEST_CASE("kernel_machine: duplicates with different labels, and two points") {
    const support::samples both{2, {1, 1, 1, 1, 1, 1, 1, 1}, {0, 1, 0, 1}};
    const auto result = train<rbf_kernel>(both, {.cost = 1e9});
    CHECK(result.converged());
    CHECK(accuracy(result.machine, both) == 0.5);
    const support::samples two{1, {-1, 1}, {5, 9}};
    CHECK(accuracy(train<rbf_kernel>(two, {.probability_folds = 5}).machine, two) == 1);
    CHECK(accuracy(train<linear_kernel>(two, {.cost = 10}).machine, two) == 1);
}

TEST_CASE("kernel_machine: samples that cannot be learnt from are refused in words") {
    support::samples s = support::blobs(20, 3, 2, 1);
    const auto error = [&] { return support::error_of([&] { (void)train<rbf_kernel>(s, {}); }); };
    s.values[3 * 7 + 2] = std::numeric_limits<float>::quiet_NaN();
    CHECK(error() == "features: row 7, column 2: expected a finite number, found nan");
    s.values[3 * 7 + 2] = std::numeric_limits<float>::infinity();
    CHECK(error() == "features: row 7, column 2: expected a finite number, found inf");
    s.values[3 * 7 + 2] = 0;
    const auto machine = train<rbf_kernel>(s, {}).machine;
    thread_pool alone;
    std::vector<float> broken(3, std::numeric_limits<float>::quiet_NaN());
    CHECK_THROWS_WITH_AS((void)machine.predict(feature_rows<>(broken, 3), alone),
                         "features: row 0, column 0: expected a finite number, found nan",
                         std::invalid_argument);
    CHECK_THROWS_AS((void)machine.predict(feature_rows<>(broken, 1), alone), std::invalid_argument);
    std::fill(s.labels.begin(), s.labels.end(), std::size_t{4});
    CHECK(error() == "labels: expected two classes or more, found only class 4");
    s.labels.pop_back();
    CHECK(error() == "labels: expected 20, one for each row, found 19");
    const support::samples none{3, {}, {}};
    CHECK_THROWS_WITH_AS((void)train<rbf_kernel>(none, {}),
                         "labels: expected two classes or more, found no samples", std::invalid_argument);
}

TEST_CASE("kernel_machine: options without a meaning are refused in words, and so is one moved from") {
    const support::samples s = support::blobs(20, 3, 2, 1);
    const auto error = [&](const kernel_training_options<rbf_kernel>& options) {
        return support::error_of([&] { (void)train<rbf_kernel>(s, options); });
    };
    for (const double tolerance :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        CHECK(error({.solver = {.tolerance = tolerance}})
                  .starts_with("tolerance: expected a finite number above 0"));
    CHECK(error({.probability_folds = 1}) ==
          "probabilities: expected 2 parts or more to cross-validate with, found 1");
    // More parts than samples are one for each sample.
    const auto sigmoids = [&](std::size_t folds) {
        return train<rbf_kernel>(s, {.probability_folds = folds}).machine.parameters().sigmoids;
    };
    const auto each = sigmoids(20), many = sigmoids(std::numeric_limits<std::size_t>::max());
    REQUIRE(each.size() == 1);
    CHECK(each[0].slope == many[0].slope);
    CHECK(each[0].offset == many[0].offset);
    CHECK(error({.class_weights = {{5, 1.0}}}) == "class weights: expected labels of the samples, found 5");
    CHECK(error({.class_weights = {{1, 1.0}, {1, 2.0}}}) ==
          "class weights: expected one for each label, found two for 1");

    thread_pool alone;
    auto machine = train<rbf_kernel>(s, {}).machine;
    const auto taken = std::move(machine);
    CHECK(taken.predict(s.rows(), alone).size() == 20);
    CHECK_THROWS_WITH_AS((void)machine.predict(s.rows(), alone), "kernel machine: it has been moved from",
                         std::logic_error);
}

TEST_CASE("kernel_machine: ten thousand classes are refused before they take the memory of their machines") {
    support::samples s{1, {}, {}};
    for (std::size_t i = 0; i < 10'000; ++i) {
        s.labels.push_back(i);
        s.values.push_back(static_cast<float>(i));
    }
    const std::string error = support::error_of([&] { (void)train<rbf_kernel>(s, {}); });
    CAPTURE(error);
    CHECK(error.starts_with(
        "support vector machines of 10000 classes from 10000 samples, one versus one: expected "
        "to need at most 4294967295 bytes of memory (memory_bytes), found "));
    const support::samples few = support::blobs(20, 3, 2, 1);
    CHECK(support::error_of([&] {
              (void)train<rbf_kernel>(few, {.memory_bytes = 1000});
          }).find("at most 1000 bytes of memory (memory_bytes), found ") != std::string::npos);
}

TEST_CASE("kernel_machine: parameters that do not fit each other are refused") {
    const auto good = train<rbf_kernel>(support::blobs(40, 3, 4, 1), {}).machine.parameters();
    const auto refused = [&](auto&& change) {
        auto parts = good;
        change(parts);
        CHECK_THROWS_AS(kernel_machine<rbf_kernel>{parts}, std::invalid_argument);
    };
    refused([](auto& p) { p.offsets.pop_back(); });
    refused([](auto& p) { p.coefficients.pop_back(); });
    refused([](auto& p) { p.support_vectors.pop_back(); });
    refused([](auto& p) { p.support_counts[0] = static_cast<std::size_t>(-1); });
    refused([](auto& p) { p.labels[1] = p.labels[0]; });
    refused([](auto& p) { p.labels.resize(1); });
    refused([](auto& p) { p.sigmoids.resize(1); });
    refused([](auto& p) { p.standardise = standardisation{{0, 0}, {1, 1, 1}}; });
    refused([](auto& p) { p.standardise = standardisation{{0, 0, 0}, {1, 1}}; });
    refused([](auto& p) { p.features = 0; });
    refused([](auto& p) {
        p.support_vectors.clear();
        p.coefficients.clear();
        p.support_counts.assign(4, 0);
        p.features = std::size_t{1} << 60;
    });
    CHECK_THROWS_AS((kernel_machine<rbf_kernel, 4>{good}), std::invalid_argument);
}

TEST_CASE("kernel_machine: labels and probabilities of many rows take blocks of memory, and are the same") {
    // A vector of each of 90 classes: 4005 machines, 32 kB of values a row.
    constexpr std::size_t classes = 90, rows = 3000;
    kernel_machine_parameters<rbf_kernel> parts;
    parts.kernel.gamma = 0.5;
    parts.features = 2;
    parts.offsets.resize(classes * (classes - 1) / 2);
    for (std::size_t c = 0; c < classes; ++c) {
        parts.labels.push_back(c);
        parts.support_counts.push_back(1);
        parts.support_vectors.insert(parts.support_vectors.end(),
                                     {static_cast<float>(c % 10), static_cast<float>(c / 10)});
        for (std::size_t other = 0; other + 1 < classes; ++other)
            parts.coefficients.push_back(other < c ? -1 : 1);
    }
    const kernel_machine<rbf_kernel> machine(parts);
    std::vector<float> values;
    for (std::size_t i = 0; i < rows; ++i)
        values.insert(values.end(), {static_cast<float>(i % 101) / 10, static_cast<float>(i % 89) / 10});
    thread_pool pool(2);
    const std::size_t before = support::bytes_allocated();
    const std::vector<std::size_t> labels = machine.predict(feature_rows<>(values, 2), pool);
    CHECK(support::bytes_allocated() - before < rows * machine.machines() * sizeof(double) / 2);
    const std::vector<double> decisions = machine.decision_values(feature_rows<>(values, 2), pool);
    bool same = labels.size() == rows;
    for (std::size_t i = 0; i < labels.size(); ++i)
        same = same && labels[i] == winning_class(std::span(decisions).subspan(i * machine.machines(),
                                                                               machine.machines()),
                                                  classes, multiclass::one_versus_one);
    CHECK(same);
}
