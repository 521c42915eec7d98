#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/training/loop/trainable.hpp>
#include <tactnet/training/loop/trainable_network.hpp>

#include <doctest/doctest.h>

#include <cstddef>
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
