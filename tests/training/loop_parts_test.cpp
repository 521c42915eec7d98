#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/loop/gradient_step.hpp>
#include <tactnet/training/loop/progress.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <support/error_of.hpp>
#include <training/toy_task.hpp>
#include <vector>

namespace {

using namespace tactnet;

using net = network<shape{6, 6}, conv2d<2, 3>, batch_norm, relu, dense<3>>;

TEST_CASE(
    "sam_perturbation: by the radius in the gradient's direction, and back with the statistics of before") {
    trainable_network<net> walker;
    const auto values = walker.learnable_values(), statistics = walker.running_statistics();
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = 0.01F * static_cast<float>(i);
    std::ranges::fill(statistics, 3.0F);
    const std::vector<float> before(values.begin(), values.end());
    std::vector<float> gradients(values.size());
    gradients[1] = 3, gradients[4] = -4;

    detail::sam_perturbation path;
    path.climb(walker, gradients, 0.5);
    CHECK(values[0] == before[0]);
    CHECK(values[1] == doctest::Approx(before[1] + 0.3F));
    CHECK(values[4] == doctest::Approx(before[4] - 0.4F));

    std::ranges::fill(statistics, 7.0F);
    path.come_back(walker);
    CHECK(std::ranges::equal(values, before));
    CHECK(std::ranges::all_of(statistics, [](float s) { return s == 3; }));
}

TEST_CASE(
    "sam_perturbation: where there is no slope nothing moves, and tiny or huge ones give the same distance") {
    trainable_network<net> walker;
    const auto values = walker.learnable_values();
    std::ranges::fill(values, 0.0F);
    std::vector<float> gradients(values.size());
    detail::sam_perturbation path;
    path.climb(walker, gradients, 0.5);
    CHECK(std::ranges::all_of(values, [](float v) { return v == 0; }));
    path.come_back(walker);
    for (const float size : {1e-30F, 1e30F}) {
        gradients[2] = size;
        path.climb(walker, gradients, 0.5);
        CHECK(values[2] == doctest::Approx(0.5F));
        path.come_back(walker);
    }
}

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
        const std::string message =
            support::error_of<std::invalid_argument>([&] { (void)training_progress::from(wrong, 2, 3); });
        CAPTURE(message);
        CHECK(message.starts_with("progress of a training"));
        CHECK(message.ends_with(", found " + std::to_string(value)));
    };
    for (const std::size_t place :
         {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 12u, 13u}) { // the last two: one of a pair
        refused(place, -1), refused(place, std::nan(""));
        if (place == 0 || place > 3) // losses are infinite before the first validation
            refused(place, never);
    }
    refused(0, 5), refused(0, 6.5);
    for (const double waited : {0.5, 3.0})
        refused(4, waited);
    for (const double stopped : {0.5, 2.0})
        refused(5, stopped);
    refused(6, -1e-9), refused(7, -1e-9);
    refused(12, -1e-9), refused(13, 1.5), refused(13, -0.5);
    CHECK_THROWS_AS((void)training_progress::from(right, 1, 3), std::invalid_argument);
    std::vector<double> short_of_one = right;
    short_of_one.pop_back();
    CHECK_THROWS_AS((void)training_progress::from(short_of_one, 2, 3), std::invalid_argument);
}

std::string problem_of(const auto& check) {
    return support::error_of<training_diverged>([&] { check(epoch_report{.epoch = 4, .rate = 0.5}); });
}

TEST_CASE("divergence: a loss or a parameter that is not finite, with epoch and rate") {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    CHECK(problem_of([](const epoch_report& r) { detail::check_loss(1e300, r, "step 1"); }) == "no error");
    CHECK(problem_of([](const epoch_report& r) { detail::check_loss(infinite, r, "step 1"); }) ==
          "training diverged in epoch 4, step 1: expected a finite loss, found inf; lower the learning rate "
          "(now 0.500000)");
    std::array values{1.0f, -3e38f};
    const auto check = [&](const epoch_report& r) { detail::check_parameters(values, r); };
    CHECK(problem_of(check) == "no error");
    values[1] = -std::numeric_limits<float>::infinity();
    CHECK(problem_of(check) ==
          "training diverged in epoch 4, last step: expected finite parameters, found -inf; "
          "lower the learning rate (now 0.500000)");
}

TEST_CASE("divergence: a second moment that is infinite, or no number") {
    std::array values{1.0f, 3e38f};
    const auto check = [&](const epoch_report& r) { detail::check_squares(values, r); };
    CHECK(problem_of(check) == "no error");
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

TEST_CASE("evaluate: refuses samples of another size or with more classes than outputs") {
    const support::toy_task task(2);
    thread_pool threads;
    const std::vector<std::size_t> all{0, 1, 2, 3, 4, 5};
    const auto evaluated = [&](const trainable& network) {
        const std::vector<float> mean(network.input_shape().size());
        return evaluate(network, mean, 1, task.images(), all, threads);
    };
    CHECK(evaluated(trainable_network<network<support::toy_task::size, dense<3>>>{}).confusion.total() == 6);
    CHECK_THROWS_AS(evaluated(trainable_network<network<support::toy_task::size, dense<2>>>{}),
                    std::invalid_argument);
    CHECK_THROWS_AS(evaluated(trainable_network<network<shape{8, 13}, dense<3>>>{}), std::invalid_argument);
}

TEST_CASE("evaluate: images that are their own reflections look the same every way round") {
    using single = network<shape{3, 5}, dense<2>>;
    thread_pool threads;
    trainable_network<single> network;
    for (std::size_t i = 0; i < network.learnable_values().size(); ++i)
        network.learnable_values()[i] = 0.01F * static_cast<float>(i % 7);
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels, all;
    for (std::size_t image = 0; image < 70; ++image) { // more than pass at once
        pixels.insert(pixels.end(), single::input_shape.size(), static_cast<std::uint8_t>(3 * image));
        labels.push_back(image % 2), all.push_back(image);
    }
    const std::vector<float> mean(single::input_shape.size(), 100);
    const labelled_images images{pixels, labels, 2};
    const evaluation once = evaluate(network, mean, 0.1F, images, all, threads),
                     averaged = evaluate(network, mean, 0.1F, images, all, threads,
                                         test_time_augmentation::reflections);
    CHECK(once.confusion.total() == 70);
    // An image that is the mean leaves only the two biases, which differ by 0.01.
    const std::vector<std::uint8_t> grey(single::input_shape.size(), 100);
    const evaluation of_mean =
        evaluate(network, mean, 0.1F, labelled_images{grey, {labels.data(), 1}, 2}, {all.data(), 1}, threads);
    CHECK(of_mean.loss == doctest::Approx(std::log(1 + std::exp(0.01))));
    CHECK(averaged.loss == doctest::Approx(once.loss).epsilon(1e-6));
    CHECK(averaged.recognised == once.recognised);
}

} // namespace
