#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <training/toy_task.hpp>
#include <vector>

using namespace tactnet;

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
    using net = network<shape{3, 5}, dense<2>>;
    thread_pool threads;
    trainable_network<net> network;
    for (std::size_t i = 0; i < network.learnable_values().size(); ++i)
        network.learnable_values()[i] = 0.01F * static_cast<float>(i % 7);
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels, all;
    for (std::size_t image = 0; image < 70; ++image) { // more than pass at once
        pixels.insert(pixels.end(), net::input_shape.size(), static_cast<std::uint8_t>(3 * image));
        labels.push_back(image % 2), all.push_back(image);
    }
    const std::vector<float> mean(net::input_shape.size(), 100);
    const labelled_images images{pixels, labels, 2};
    const evaluation once = evaluate(network, mean, 0.1F, images, all, threads),
                     averaged = evaluate(network, mean, 0.1F, images, all, threads,
                                         test_time_augmentation::reflections);
    CHECK(once.confusion.total() == 70);
    // An image that is the mean leaves only the two biases, which differ by 0.01.
    const std::vector<std::uint8_t> grey(net::input_shape.size(), 100);
    const evaluation of_mean =
        evaluate(network, mean, 0.1F, labelled_images{grey, {labels.data(), 1}, 2}, {all.data(), 1}, threads);
    CHECK(of_mean.loss == doctest::Approx(std::log(1 + std::exp(0.01))));
    CHECK(averaged.loss == doctest::Approx(once.loss).epsilon(1e-6));
    CHECK(averaged.recognised == once.recognised);
}
