#include <tactnet/training/loop/progress.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

training_progress two_epochs() {
    training_progress p{.steps = 6,
                        .best_loss = 0.5,
                        .smoothed_loss = 0.75,
                        .smallest_loss = 0.25,
                        .waited = 2,
                        .stopped = true,
                        .history = {}};
    p.history.push_back({1, 0.125, 2, std::nan(""), std::nan("")});
    p.history.push_back({2, 0, 0, 0, 1});
    return p;
}

} // namespace

TEST_CASE("training_progress: numbers and back, at the ends of what may be") {
    const training_progress before = two_epochs(), after = training_progress::from(before.numbers(), 2, 3);
    CHECK(after.steps == 6);
    CHECK(after.best_loss == 0.5);
    CHECK(after.smoothed_loss == 0.75);
    CHECK(after.smallest_loss == 0.25);
    CHECK(after.waited == 2);
    CHECK(after.stopped);
    REQUIRE(after.history.size() == 2);
    CHECK(after.history[0].epoch == 1);
    CHECK(after.history[0].rate == 0.125);
    CHECK(after.history[0].loss == 2);
    CHECK(std::isnan(after.history[0].validation_loss));
    CHECK(after.history[1].epoch == 2);
    CHECK(after.history[1].rate == 0);
    CHECK(after.history[1].validation_loss == 0);
    CHECK(after.history[1].validation_accuracy == 1);

    training_progress begun;
    CHECK(!training_progress::from(begun.numbers(), 2, 3).stopped);
}

TEST_CASE("training_progress: numbers that no training has are refused, each at its place") {
    const std::vector<double> right = two_epochs().numbers();
    const double never = std::numeric_limits<double>::infinity();
    const auto refused = [&](std::size_t place, double value) {
        std::vector<double> wrong = right;
        wrong.at(place) = value;
        CHECK_THROWS_AS((void)training_progress::from(wrong, 2, 3), std::invalid_argument);
    };
    refused(0, 5);
    for (const std::size_t loss : {1u, 2u, 3u})
        refused(loss, -1), refused(loss, std::nan(""));
    for (const double waited : {-1.0, 0.5, 3.0})
        refused(4, waited);
    for (const double stopped : {-1.0, 0.5, 2.0})
        refused(5, stopped);
    refused(6, -1e-9), refused(6, never); // a rate
    refused(7, -1e-9), refused(7, std::nan(""));
    refused(12, -1e-9), refused(13, 1.5), refused(13, -0.5);
    refused(12, std::nan("")); // a loss without its accuracy
    CHECK_THROWS_AS((void)training_progress::from(right, 1, 3), std::invalid_argument);
    std::vector<double> short_of_one = right;
    short_of_one.pop_back();
    CHECK_THROWS_AS((void)training_progress::from(short_of_one, 2, 3), std::invalid_argument);
}

namespace {

template <class Check>
std::string problem_of(const Check& check) {
    try {
        check(epoch_report{.epoch = 4, .rate = 0.5});
    } catch (const training_diverged& error) {
        return error.what();
    }
    return {};
}

} // namespace

TEST_CASE("divergence: a loss or a parameter that is not finite, with epoch and rate") {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    CHECK(problem_of([](const epoch_report& r) { detail::check_loss(1e300, r, "step 1"); }).empty());
    CHECK(problem_of([](const epoch_report& r) { detail::check_loss(infinite, r, "step 1"); }) ==
          "training diverged in epoch 4, step 1: expected a finite loss, found inf; lower the learning rate "
          "(now 0.500000)");
    std::array values{1.0f, -3e38f};
    const auto check = [&](const epoch_report& r) { detail::check_parameters(values, r); };
    CHECK(problem_of(check).empty());
    values[1] = -std::numeric_limits<float>::infinity();
    CHECK(problem_of(check) ==
          "training diverged in epoch 4, last step: expected finite parameters, found -inf; "
          "lower the learning rate (now 0.500000)");
}

TEST_CASE("divergence: a second moment that is infinite, or no number") {
    std::array values{1.0f, 3e38f};
    const auto check = [&](const epoch_report& r) { detail::check_squares(values, r); };
    CHECK(problem_of(check).empty());
    values[1] = std::numeric_limits<float>::infinity();
    CHECK(problem_of(check) ==
          "training diverged in epoch 4, its steps: expected gradients whose squares are finite, found "
          "inf; lower the learning rate (now 0.500000)");
    values[1] = std::numeric_limits<float>::quiet_NaN();
    CHECK(problem_of(check).starts_with("training diverged in epoch 4, its steps: "));
}

TEST_CASE("early_stopping: after `patience` checks without a smaller loss") {
    early_stopping stopping{3};
    CHECK(!stopping.check(2));
    CHECK(!stopping.check(1));
    CHECK(!stopping.check(1)); // no better
    CHECK(!stopping.check(5));
    CHECK(!stopping.check(0.5));
    CHECK(stopping.waited == 0);
    CHECK(!stopping.check(std::numeric_limits<double>::quiet_NaN()));
    CHECK(!stopping.check(0.6));
    CHECK(stopping.check(0.7));
    CHECK(stopping.smallest == 0.5);

    early_stopping again{3, 0.5, 2};
    CHECK(again.check(0.5));
    early_stopping at_once{1};
    CHECK(!at_once.check(2));
    CHECK(at_once.check(2));
    early_stopping never;
    for (int i = 0; i < 100; ++i)
        CHECK(!never.check(1));
}
