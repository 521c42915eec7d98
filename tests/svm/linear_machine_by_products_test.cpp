#include "samples.hpp"

#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/linear_machine.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

using namespace tactnet;

namespace {

auto train(const support::samples& s, const linear_product_options& options, std::size_t threads = 1) {
    thread_pool pool(threads);
    return train_linear_machine_by_products(s.rows(), s.labels, options, pool);
}

} // namespace

TEST_CASE("linear_by_products: values are those of a kernel machine of the linear kernel, one versus rest") {
    const support::samples s = support::blobs(60, 700, 4, 2), fresh = support::blobs(40, 700, 4, 2, 2);
    thread_pool pool(1);
    for (const bool standardise : {false, true})
        for (const double cost : {1e-3, 1.0}) {
            const auto expected = train_kernel_machine<linear_kernel>(
                s.rows(), s.labels,
                {.cost = cost, .scheme = multiclass::one_versus_rest, .standardise = standardise}, pool);
            const auto found = train(s, {.cost = cost, .standardise = standardise});
            CHECK(found.converged());
            CHECK(found.machine.parameters().labels == expected.machine.parameters().labels);
            CHECK(found.machine.parameters().offsets == expected.machine.parameters().offsets);
            const auto& parts = expected.machine.parameters();
            const std::vector<double> a = found.machine.decision_values(fresh.rows()),
                                      b = expected.machine.decision_values(fresh.rows(), pool);
            REQUIRE(a.size() == b.size());
            const std::vector<float> standard =
                parts.standardise ? parts.standardise->apply(fresh.rows()) : fresh.values;
            for (std::size_t i = 0; i < fresh.labels.size(); ++i)
                for (std::size_t c = 0; c < 4; ++c) {
                    // Both add up single-precision products: at most one rounding of each, and of each sum.
                    double magnitude = 0;
                    for (std::size_t v = 0; v < expected.machine.support_vectors(); ++v)
                        for (std::size_t f = 0; f < s.features; ++f)
                            magnitude += std::abs(parts.coefficients[v * 4 + c] *
                                                  double{parts.support_vectors[v * s.features + f]} *
                                                  double{standard[i * s.features + f]});
                    const double bound = 2 * static_cast<double>(s.features + 2) *
                                         std::numeric_limits<float>::epsilon() / 2 * magnitude;
                    CHECK(std::abs(a[i * 4 + c] - b[i * 4 + c]) <= bound);
                }
        }
}

TEST_CASE("linear_by_products: bit-exact on any number of threads") {
    const support::samples s = support::blobs(50, 300, 5, 1);
    const auto alone = train(s, {});
    for (const std::size_t threads : {2U, 3U, 7U}) {
        const auto many = train(s, {}, threads);
        CHECK(many.machine.parameters().weights == alone.machine.parameters().weights);
        CHECK(many.machine.parameters().offsets == alone.machine.parameters().offsets);
    }
    // Rows of the matrix that are computed apart give the same machine, but for their rounding.
    linear_product_options apart;
    apart.solver.cache_bytes = 1;
    CHECK(train(s, apart).machine.predict(s.rows()) == alone.machine.predict(s.rows()));
}

TEST_CASE("linear_by_products: a class weight moves the border towards the others") {
    const support::samples s = support::blobs(200, 3, 2, 2);
    const auto of_first = [&](double weight) {
        const auto found = train(s, {.cost = 0.1, .class_weights = {{0, weight}}}).machine.predict(s.rows());
        return std::count(found.begin(), found.end(), std::size_t{0});
    };
    CHECK(of_first(10) > of_first(1));
    CHECK(of_first(0.1) < of_first(1));
}

TEST_CASE("linear_by_products: samples that cannot be learnt from") {
    support::samples s = support::blobs(10, 3, 2, 1);
    CHECK(support::error_of([&] { train({3, s.values, std::vector<std::size_t>(10)}, {}); }) != "");
    s.values[4] = std::numeric_limits<float>::quiet_NaN();
    CHECK_THROWS_AS(train(s, {}), std::invalid_argument);
}
