#include "samples.hpp"

#include <tactnet/svm/grid_search.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <stdexcept>
#include <vector>

using namespace tactnet;

namespace {

search_grid<rbf_kernel> small_grid() {
    return {{{1e-4}, {0.1}, {}, {1e4}}, {0.01, 1, 100}, 4};
}
auto search_on(const support::samples& s, const kernel_training_options<rbf_kernel>& options,
               std::size_t threads = 1) {
    thread_pool pool(threads);
    return grid_search(small_grid(), s.rows(), s.labels, options, pool);
}

} // namespace

TEST_CASE(
    "grid_search: accuracies are those of machines trained on the rest; the best is the best of these") {
    const support::samples s = support::blobs(160, 5, 4, 0.6);
    for (const bool standardise : {false, true})
        for (const multiclass scheme : {multiclass::one_versus_one, multiclass::one_versus_rest}) {
            kernel_training_options<rbf_kernel> options{.scheme = scheme, .standardise = standardise};
            const auto found = search_on(s, options);
            REQUIRE(found.accuracies.size() == 12);
            const auto grid = small_grid();
            const auto folds = stratified_folds(s.labels, 4);
            double best = 0;
            thread_pool alone;
            for (std::size_t k = 0; k < 4; ++k)
                for (std::size_t c = 0; c < 3; ++c) {
                    std::size_t right = 0;
                    for (std::size_t f = 0; f < 4; ++f) {
                        support::samples training{5, {}, {}}, held{5, {}, {}};
                        for (std::size_t i = 0; i < 160; ++i) {
                            auto& to = folds[i] == f ? held : training;
                            to.values.insert(to.values.end(), s.rows().row(i).begin(), s.rows().row(i).end());
                            to.labels.push_back(s.labels[i]);
                        }
                        options.kernel = grid.kernels[k];
                        options.cost = grid.costs[c];
                        const auto machine =
                            train_kernel_machine(training.rows(), training.labels, options, alone).machine;
                        const auto labels = machine.predict(held.rows(), alone);
                        for (std::size_t i = 0; i < labels.size(); ++i)
                            right += labels[i] == held.labels[i] ? 1 : 0;
                    }
                    const double accuracy = static_cast<double>(right) / 160;
                    best = std::max(best, accuracy);
                    CAPTURE(k);
                    CAPTURE(c);
                    // One sample may lie on a border within rounding.
                    CHECK(std::abs(found.accuracies[k * 3 + c] - accuracy) <= 1.0 / 160 + 1e-12);
                }
            CHECK(std::abs(found.accuracy - best) <= 1.0 / 160 + 1e-12);
            CHECK(found.converged);
            const auto first_best =
                static_cast<std::size_t>(std::max_element(found.accuracies.begin(), found.accuracies.end()) -
                                         found.accuracies.begin());
            CHECK(found.accuracy == found.accuracies[first_best]);
            CHECK(found.kernel.gamma == grid.kernels[first_best / 3].gamma);
            CHECK(found.cost == grid.costs[first_best % 3]);
        }
}

TEST_CASE("grid_search: the same on any number of threads, with all pairs stored or rows found one by one") {
    const support::samples s = support::blobs(120, 5, 3, 0.6);
    kernel_training_options<rbf_kernel> options{};
    const auto one = search_on(s, options), three = search_on(s, options, 3);
    CHECK(one.accuracies == three.accuracies);
    CHECK(one.kernel.gamma == three.kernel.gamma);
    CHECK(one.cost == three.cost);
    options.solver.cache_bytes = 0;
    CHECK(search_on(s, options, 2).accuracies == one.accuracies);
}

TEST_CASE(
    "grid_search: a class with one sample is missing from the training of a part, and not recognised there") {
    support::samples s = support::blobs(41, 3, 2, 0.05);
    s.labels[40] = 2;
    const auto found = search_on(s, {});
    CHECK(found.accuracy == doctest::Approx((3 + 10.0 / 11) / 4)); // the mean over folds of 11, 10, 10, 10
    const support::samples pair{1, {0, 1}, {0, 1}};
    thread_pool alone;
    const search_grid<rbf_kernel> grid{{{}}, {1}, 2};
    CHECK(grid_search(grid, pair.rows(), pair.labels, {}, alone).accuracy ==
          0); // one class left in each part
}

TEST_CASE("grid_search: of equal ones the first is the best; a limit of iterations is reported") {
    const support::samples s = support::blobs(60, 3, 2, 0.02);
    thread_pool alone;
    const search_grid<rbf_kernel> grid{{{0.5}, {1.0}}, {3, 1, 10}, 3};
    const auto found = grid_search(grid, s.rows(), s.labels, {}, alone);
    CHECK(found.accuracies == std::vector<double>(6, 1.0));
    CHECK(found.cost == 3);
    CHECK(*found.kernel.gamma == 0.5);
    CHECK(found.converged);
    const support::samples wide = support::blobs(60, 3, 2, 1);
    kernel_training_options<rbf_kernel> hurried;
    hurried.solver.iteration_limit = 1;
    CHECK_FALSE(grid_search(grid, wide.rows(), wide.labels, hurried, alone).converged);
}

TEST_CASE("grid_search: a group is never on both sides") {
    // Recordings of four samples at one place each: a neighbour of the same recording tells the class, which
    // is drawn by lot; other recordings say nothing of it.
    support::samples s{2, {}, {}};
    search_grid<rbf_kernel> grid{{{100.0}}, {100}, 5};
    for (std::size_t i = 0; i < 80; ++i) {
        s.values.insert(s.values.end(), {static_cast<float>(i % 20), static_cast<float>(i) * 0.0001F});
        s.labels.push_back(i % 20 * 7 % 11 % 2);
        grid.groups.push_back(i % 20);
    }
    thread_pool alone;
    const auto accuracy = [&] { return grid_search(grid, s.rows(), s.labels, {}, alone).accuracy; };
    const double by_fives = accuracy();
    CHECK(by_fives < 0.75);
    grid.folds = 0; // one group at a time
    CHECK(accuracy() < 0.75);
    CHECK(accuracy() != by_fives);
    grid.groups.pop_back();
    CHECK_THROWS_AS((void)accuracy(), std::invalid_argument);
    grid.groups.clear(), grid.folds = 5;
    CHECK(accuracy() == 1);
}

TEST_CASE("grid_search: more than the memory allowed is refused") {
    const support::samples s = support::blobs(20, 3, 2, 1);
    thread_pool alone;
    kernel_training_options<rbf_kernel> narrow;
    narrow.memory_bytes = 1000;
    CHECK_THROWS_AS(
        (void)grid_search(search_grid<rbf_kernel>{{{}}, {1}, 5}, s.rows(), s.labels, narrow, alone),
        std::invalid_argument);
}

TEST_CASE("grid_search: nothing to try is refused") {
    const support::samples s = support::blobs(20, 3, 2, 1);
    thread_pool alone;
    const auto refused = [&](const search_grid<rbf_kernel>& grid) {
        CHECK_THROWS_AS((void)grid_search(grid, s.rows(), s.labels, {}, alone), std::invalid_argument);
    };
    refused({{}, {1}, 5});
    refused({{{}}, {}, 5});
    refused({{{}}, {1}, 1});
    refused({{{}}, {1}, 21});
    refused({{{}}, {-1}, 5});
    refused({{{-1.0}}, {1}, 5});
}
