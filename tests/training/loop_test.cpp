#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/training/loop.hpp>
#include <tactnet/training/loop/trainable_network.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <training/toy_task.hpp>
#include <vector>

// trainer_test.cpp tests the training itself, through a network whose type is known.

using namespace tactnet;

namespace {

using net = network<support::toy_task::size, conv2d<4, 3>, batch_norm, relu, max_pool<4>, dense<3>>;

} // namespace

TEST_CASE("training_loop: networks of a type that it does not know") {
    const support::toy_task task(20);
    thread_pool threads;
    recipe how;
    how.epochs = 3;
    how.batch = 16;
    const data_split split = split_data(task.labels, 3, split_rule::random, 1);
    training_loop loop(std::make_unique<trainable_network<net>>(), how, task.images(), split, 1, threads);
    while (!loop.finished())
        loop.run_epoch();
    REQUIRE(loop.mean().size() == support::toy_task::size.size());

    // What the best network does, by its type and without.
    const net& best = static_cast<const trainable_network<net>&>(loop.best()).network();
    normalisation<net::input_shape> normalise;
    std::copy(loop.mean().begin(), loop.mean().end(), normalise.mean.begin());
    normalise.scale = loop.scale();
    const evaluation typed = evaluate(best, normalise, task.images(), split.test, threads);
    const evaluation any =
        evaluate(loop.best(), loop.mean(), loop.scale(), task.images(), split.test, threads);
    CHECK(typed.loss == any.loss);
    CHECK(typed.recognised == any.recognised);
    CHECK(typed.confusion.total() == split.test.size());

    // A copy is another network.
    const std::unique_ptr<trainable> copy = loop.best().copy();
    CHECK(std::ranges::equal(copy->learnable_values(), best.learnable_values()));
    copy->learnable_values()[0] += 1;
    CHECK(copy->learnable_values()[0] != best.learnable_values()[0]);
    CHECK_THROWS_AS(loop.start_from(copy->learnable_values(), copy->running_statistics()), std::logic_error);
    // Arrays of another network.
    CHECK_THROWS_AS(copy->take(copy->learnable_values().first(3), copy->running_statistics()),
                    std::invalid_argument);
}
