// The same optimum and the same answers as LIBSVM and LIBLINEAR.

#include "decode_image.hpp"
#include "samples.hpp"

#include <tactnet/svm/kernel_machine.hpp>
#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/linear_machine.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <peers/support_vector_machines.hpp>
#include <support/files/data_folder.hpp>
#include <support/machine_comparison.hpp>
#include <support/pixels.hpp>
#include <vector>

using namespace tactnet;
using benchmark::agreement;

namespace {

void compare_rbf(feature_rows<> rows, const std::vector<std::size_t>& labels, feature_rows<> fresh,
                 double cost) {
    thread_pool alone;
    const auto own =
        train_kernel_machine(rows, labels, kernel_training_options<rbf_kernel>{.cost = cost}, alone);
    const benchmark::libsvm_machine peer(rows, labels, *own.machine.parameters().kernel.gamma, cost);
    double objective = 0;
    for (const solver_report& report : own.reports)
        objective += report.objective;
    CAPTURE(cost);
    CHECK(own.converged());
    CHECK(std::abs(objective - peer.objective()) <= 1e-3 * std::abs(peer.objective()));
    CHECK(agreement(own.machine.predict(fresh, alone), peer.predict(fresh)) >= 0.995);
}

void compare_linear(feature_rows<> rows, const std::vector<std::size_t>& labels, feature_rows<> fresh,
                    linear_loss loss, double cost) {
    thread_pool alone;
    const double tolerance = 1e-3;
    linear_training_options options{.cost = cost};
    options.solver = {.loss = loss, .tolerance = tolerance, .iteration_limit = 100'000};
    const auto own = train_linear_machine(rows, labels, options, alone);
    const benchmark::liblinear_machine peer(rows, labels, loss, cost, tolerance);
    const auto objective = [&](auto&& weights) {
        return benchmark::primal_objective(rows, labels, loss, cost, own.machine.classes(), weights);
    };
    const double found =
        objective([&](std::size_t c) { return benchmark::weights_of(own.machine.parameters(), c); });
    const double expected = objective([&](std::size_t c) { return peer.weights(c); });
    CAPTURE(cost);
    CHECK(own.converged());
    CHECK(std::abs(found - expected) <= 1e-3 * expected);
    CHECK(agreement(own.machine.predict(fresh), peer.predict(fresh)) >= 0.995);
}

} // namespace

TEST_CASE("kernel_machine: synthetic sets, LIBSVM's optimum and answers") {
    const support::samples s = support::blobs(500, 16, 5, 0.8), fresh = support::blobs(2000, 16, 5, 0.8);
    for (const double cost : {0.1, 1.0, 100.0})
        compare_rbf(s.rows(), s.labels, fresh.rows(), cost);
}

TEST_CASE("linear_machine: synthetic sets, LIBLINEAR's optimum and answers") {
    const support::samples s = support::blobs(500, 16, 5, 0.8), fresh = support::blobs(2000, 16, 5, 0.8);
    for (const linear_loss loss : {linear_loss::hinge, linear_loss::squared_hinge})
        for (const double cost : {0.01, 1.0})
            compare_linear(s.rows(), s.labels, fresh.rows(), loss, cost);
}

TEST_CASE("kernel_machine: real pixels, LIBSVM's optimum and answers" * doctest::test_suite("data")) {
    const auto folder = support::find_data("tactile_images");
    if (!folder)
        return;
    const auto split = benchmark::split_pixels(benchmark::load_pixels(*folder, decode_image), 1);
    for (const double cost : {1.0, 10.0})
        compare_rbf(split.training.view(), split.training.labels, split.test.view(), cost);
}

TEST_CASE("linear_machine: real pixels, LIBLINEAR's optimum and answers" * doctest::test_suite("data")) {
    const auto folder = support::find_data("tactile_images");
    if (!folder)
        return;
    const auto split = benchmark::split_pixels(benchmark::load_pixels(*folder, decode_image), 1);
    for (const linear_loss loss : {linear_loss::hinge, linear_loss::squared_hinge})
        compare_linear(split.training.view(), split.training.labels, split.test.view(), loss, 0.1);
}
