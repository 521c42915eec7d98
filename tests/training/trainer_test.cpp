#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/trainer.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <support/error_of.hpp>
#include <training/toy_task.hpp>
#include <vector>

using namespace tactnet;

namespace {

using net = network<support::toy_task::size, conv2d<6, 3>, batch_norm, relu, max_pool<2>, conv2d<8, 3>,
                    batch_norm, relu, max_pool<2>, dropout<10>, dense<3>>;
using training = trainer<net>;

recipe quick() {
    recipe r;
    r.epochs = 12;
    r.batch = 16;
    r.ranges = {.reflect_rows = 0.5, .reflect_columns = 0.5, .translation = 1, .rotation = 5};
    return r;
}
data_split split_of(const support::toy_task& task) {
    return split_data(task.labels, 3, split_rule::random, 1);
}

struct toy_setup {
    support::toy_task task;
    thread_pool threads;
    recipe how = quick();

    explicit toy_setup(std::size_t each = 20) : task(each) {}
    training begin(const data_split& split, std::uint64_t seed = 1) {
        return training(how, task.images(), split, seed, threads);
    }
    training begin(std::uint64_t seed = 1) { return begin(split_of(task), seed); }
};

/// All that a training holds, bit by bit.
std::vector<char> bits_of(training& t) {
    std::vector<char> bits;
    const auto append = [&](const void* from, std::size_t size) {
        bits.insert(bits.end(), static_cast<const char*>(from), static_cast<const char*>(from) + size);
    };
    t.for_each_state([&](auto, auto values) { append(values.data(), values.size_bytes()); });
    const std::vector<double> progress = t.progress();
    append(progress.data(), progress.size() * sizeof(double));
    return bits;
}
void run(training& t, std::size_t epochs) {
    for (std::size_t i = 0; i < epochs && !t.finished(); ++i)
        t.run_epoch();
}

} // namespace

TEST_CASE("trainer: learns to distinguish three patterns") {
    const support::toy_task task(60);
    thread_pool threads(2);
    recipe r = quick();
    r.epochs = 40;
    training t(r, task.images(), split_of(task), 1, threads);
    run(t, 100);
    CHECK(t.finished());
    CHECK(t.history().size() == 40);
    CHECK(t.history().back().loss < t.history().front().loss);
    const evaluation result =
        evaluate(t.best(), t.input_normalisation(), task.images(), t.split().test, threads);
    MESSAGE("accuracy on test images: " << result.confusion.accuracy());
    CHECK(result.confusion.total() == 36);
    REQUIRE(result.logits.size() == 36 * result.confusion.classes());
    for (std::size_t i = 0; i < 36; ++i)
        CHECK(first_largest(std::span(result.logits)
                                .subspan(i * result.confusion.classes(), result.confusion.classes())) ==
              result.recognised[i]);
    CHECK(result.confusion.accuracy() > 0.95);
    CHECK(result.recognised.size() == 36);
    CHECK(result.loss < 0.4);
}

TEST_CASE("trainer: the same bits on any number of threads and on every run, for every way to augment") {
    const support::toy_task task(20);
    for (const augmentation_rule rule :
         {augmentation_rule::none, augmentation_rule::each_epoch, augmentation_rule::sixfold}) {
        recipe r = quick();
        r.augmentation = rule;
        r.remeasure_statistics = rule == augmentation_rule::none;
        r.averaging = rule == augmentation_rule::each_epoch ? 0.9 : 0;
        std::vector<char> expected;
        for (const std::size_t count : {1u, 2u, 3u, 1u}) {
            thread_pool threads(count);
            training t(r, task.images(), split_of(task), 7, threads);
            run(t, 3);
            if (expected.empty())
                expected = bits_of(t);
            CHECK(bits_of(t) == expected);
        }
        thread_pool threads;
        training other(r, task.images(), split_of(task), 8, threads);
        run(other, 3);
        CHECK(bits_of(other) != expected);
    }
}

TEST_CASE("trainer: stopped and gone on with, the same bits as in one go") {
    toy_setup setup;
    setup.how.averaging = 0.9;
    setup.how.patience = 5;
    for (const optimiser& rule : {optimiser(adamw{}), optimiser(sgd{.momentum = 0.8, .l2 = 1e-4})}) {
        setup.how.optimiser = rule;
        setup.how.schedule =
            std::holds_alternative<sgd>(rule) ? schedule(step_drop{2, 0.5}) : schedule(one_cycle{});
        training whole = setup.begin(3);
        run(whole, 6);

        training first = setup.begin(3);
        run(first, 2);
        std::map<std::string, std::vector<float>> kept;
        first.for_each_state(
            [&](auto name, auto values) { kept[std::string(name)].assign(values.begin(), values.end()); });
        const std::vector<double> progress = first.progress();

        training second = setup.begin(3);
        second.for_each_state([&](auto name, auto values) {
            const std::vector<float>& from = kept.at(std::string(name));
            REQUIRE(from.size() == values.size());
            std::copy(from.begin(), from.end(), values.begin());
        });
        second.restore(progress);
        CHECK(second.history().size() == 2);
        CHECK(bits_of(second) == bits_of(first));
        run(second, 4);
        CHECK(bits_of(second) == bits_of(whole));
        CHECK(bits_of(second) != bits_of(first));
    }
}

TEST_CASE("trainer: progress that no training with its recipe has is refused, and nothing is changed") {
    toy_setup setup;
    setup.how.epochs = 3;
    training t = setup.begin(3);
    CHECK_NOTHROW(t.restore(t.progress())); // infinite losses before the first validation
    run(t, 3);
    const std::vector<double> right = t.progress();
    CHECK_NOTHROW(t.restore(right));
    const std::vector<char> before = bits_of(t);
    const auto refused = [&](const std::vector<double>& wrong, const std::string& found) {
        const std::string message = support::error_of<std::invalid_argument>([&] { t.restore(wrong); });
        CAPTURE(message);
        CHECK(message.starts_with("progress of a training"));
        CHECK(message.ends_with(", found " + found));
        CHECK(bits_of(t) == before);
    };
    // loop_parts_test.cpp shows which numbers are refused.
    std::vector<double> more_steps = right, longer = right;
    more_steps[0] += 1;
    refused(more_steps, std::to_string(right[0] + 1));
    longer.insert(longer.end(), right.end() - 4, right.end());
    refused(longer, "4");
    refused({}, "0");
}

TEST_CASE("trainer: starts from another network, with its own epsilon and normalisation") {
    toy_setup setup{60};
    training taught = setup.begin();
    run(taught, 100);

    setup.how.epsilon = 2e-5;
    training fresh = setup.begin(2), started = setup.begin(2);
    started.start_from(taught.best());
    CHECK(std::ranges::equal(started.latest().learnable_values(), taught.best().learnable_values()));
    CHECK(std::ranges::equal(started.best().running_statistics(), taught.best().running_statistics()));
    CHECK(started.latest().epsilon == 2e-5);
    run(fresh, 1), run(started, 1);
    CHECK(started.history().front().loss < 0.8 * fresh.history().front().loss);
    CHECK_THROWS_AS(started.start_from(taught.best()), std::logic_error);
}

TEST_CASE("trainer: a training that diverges stops and reports it") {
    toy_setup setup;
    setup.how.optimiser = sgd{.momentum = 0.9};
    setup.how.schedule = constant_rate{};
    setup.how.rate = 1e30;
    training t = setup.begin();
    const std::string message = support::error_of<training_diverged>([&] { run(t, 10); });
    CHECK(message.find("training diverged in epoch ") == 0);
    CHECK(message.find("expected a finite loss") != std::string::npos);
}

TEST_CASE("trainer: a training that diverges in its very last step is reported too") {
    toy_setup setup;
    setup.how.epochs = 1;
    setup.how.batch = 0; // one step, whose loss is that of the first parameters
    setup.how.optimiser = sgd{.momentum = 0.9};
    setup.how.schedule = constant_rate{};
    const auto message = [&](double rate, const data_split& split) {
        setup.how.rate = rate;
        training t = setup.begin(split);
        return support::error_of<training_diverged>([&] { t.run_epoch(); });
    };
    data_split split = split_of(setup.task);
    CHECK(message(1e-3, split) == "no error");
    CHECK(message(1e30, split).find("training diverged in epoch 1, validation: expected a finite loss") == 0);
    CHECK(message(1e300, split).find("training diverged in epoch 1, last step: expected finite parameters") ==
          0);
    split.validation.clear();
    CHECK(message(1e300, split).find("training diverged in epoch 1, last step: expected finite parameters") ==
          0);
}

TEST_CASE("trainer: keeps the network that was best on the validation images") {
    toy_setup setup;
    setup.how.epochs = 30;
    const data_split split = split_of(setup.task);
    // Some wrong labels: the more a network is sure of what it learnt, the worse it is judged.
    for (std::size_t i = 0; i < split.validation.size(); i += 3)
        setup.task.labels[split.validation[i]] = (setup.task.labels[split.validation[i]] + 1) % 3;
    training t = setup.begin(split);
    double smoothed = 0, smallest = 0, loss = 0;
    bool kept_an_older = false, took_a_newer = false;
    std::vector<float> best;
    while (!t.finished()) {
        const epoch_report& report = t.run_epoch();
        smoothed = report.epoch == 1 ? report.validation_loss : 0.8 * smoothed + 0.2 * report.validation_loss;
        if (report.epoch == 1 || smoothed <= smallest) {
            took_a_newer = report.epoch > 1;
            smallest = smoothed, loss = report.validation_loss;
            best.assign(t.latest().learnable_values().begin(), t.latest().learnable_values().end());
        } else {
            kept_an_older = true;
        }
        CHECK(std::equal(best.begin(), best.end(), t.best().learnable_values().begin()));
        const evaluation again = evaluate(t.best(), t.input_normalisation(), setup.task.images(),
                                          t.split().validation, setup.threads);
        CHECK(again.loss == loss);
    }
    CHECK(kept_an_older); // or nothing was tested
    CHECK(took_a_newer);
}

TEST_CASE(
    "trainer: statistics measured anew are those of the network that is validated, over images as they are") {
    toy_setup setup;
    setup.how.epochs = 4;
    setup.how.augmentation = augmentation_rule::each_epoch; // the statistics are not those of varied images
    setup.how.remeasure_statistics = true;
    // Means and variances of batch norms in one batch of all training images.
    const auto measured = [&](const training& t) {
        net network = t.latest();
        net::workspace space;
        net::input_batch in(t.split().training.size());
        net::output_batch out(t.split().training.size());
        for (std::size_t i = 0; i < in.samples(); ++i)
            in.set(i, t.input_normalisation().apply(
                          setup.task.images().image<net::input_shape>(t.split().training[i])));
        network.momentum = 1;
        network.prepare(setup.threads, space);
        network.forward(in, out, setup.threads, space);
        return network;
    };
    const auto check = [&](const net& found, const net& expected, std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i)
            CHECK(found.running_statistics()[i] ==
                  doctest::Approx(expected.running_statistics()[i]).epsilon(1e-4));
    };
    for (const double averaging : {0.0, 0.9}) {
        setup.how.averaging = averaging;
        setup.how.batch = 0;
        data_split split = split_of(setup.task);
        training whole = setup.begin(split);
        run(whole, 4);
        check(whole.latest(), measured(whole), 0, net::statistics);
        CHECK(whole.latest().momentum == net().momentum);

        split.validation.clear(); // then it is the network at the end that matters
        training alone = setup.begin(split);
        run(alone, 4);
        check(alone.best(), measured(alone), 0, net::statistics);

        setup.how.batch = 11; // sizes that differ: 39 images in steps of 9, 10, 10 and 10
        training small = setup.begin();
        run(small, 4);
        // In front of the first batch norm nothing depends on the batch: the mean over batches is that of
        // all.
        for (const parameter& p : net::describe())
            if (p.name == "bn1.running_mean")
                check(small.latest(), measured(small), p.offset, p.size);
    }
}

TEST_CASE("trainer: a softmax at the end of the list changes nothing in training and evaluation") {
    toy_setup setup;
    using bare = network<support::toy_task::size, conv2d<4, 3>, relu, max_pool<4>, dense<3>>;
    using ending = network<support::toy_task::size, conv2d<4, 3>, relu, max_pool<4>, dense<3>, softmax>;
    trainer<bare> first(quick(), setup.task.images(), split_of(setup.task), 1, setup.threads);
    trainer<ending> second(quick(), setup.task.images(), split_of(setup.task), 1, setup.threads);
    for (int i = 0; i < 3; ++i)
        first.run_epoch(), second.run_epoch();
    CHECK(first.progress() == second.progress());
    const auto values = first.best().learnable_values();
    CHECK(std::equal(values.begin(), values.end(), second.best().learnable_values().begin()));
    const evaluation a = evaluate(first.best(), first.input_normalisation(), setup.task.images(),
                                  first.split().test, setup.threads);
    const evaluation b = evaluate(second.best(), second.input_normalisation(), setup.task.images(),
                                  second.split().test, setup.threads);
    CHECK(a.loss == b.loss);
    CHECK(a.recognised == b.recognised);
}

TEST_CASE("trainer: validates when due, and stops when nothing gets better") {
    toy_setup setup;
    setup.how.epochs = 7;
    setup.how.validate_every = 3;
    training t = setup.begin();
    run(t, 100);
    REQUIRE(t.history().size() == 7);
    for (const epoch_report& e : t.history())
        CHECK(std::isnan(e.validation_loss) == !(e.epoch == 3 || e.epoch == 6 || e.epoch == 7));

    setup.how.epochs = 100;
    setup.how.validate_every = 1;
    setup.how.patience = 2;
    setup.how.rate = 0; // nothing moves but the running statistics, which settle
    setup.how.augmentation = augmentation_rule::none;
    setup.how.schedule = constant_rate{};
    setup.how.batch = 0;
    training idle = setup.begin();
    run(idle, 1000);
    CHECK(idle.finished());
}

TEST_CASE("trainer: input as counts minus the mean of the training images, scaled, or as they are") {
    toy_setup setup;
    training centred = setup.begin();
    CHECK(centred.input_normalisation().scale == 1);
    const auto mean = normalisation<net::input_shape>::mean_of(setup.task.pixels, centred.split().training);
    CHECK(std::equal(mean.begin(), mean.end(), centred.input_normalisation().mean.begin()));
    setup.how.input = input_rule::scale;
    training scaled = setup.begin();
    CHECK(scaled.input_normalisation().scale == 1.0f / 255);
    CHECK(scaled.input_normalisation().mean(3, 3) == 0);
    setup.how.input = input_rule::counts;
    training raw = setup.begin();
    CHECK(raw.input_normalisation().scale == 1);
    CHECK(raw.input_normalisation().mean(3, 3) == 0);
    setup.how.input = input_rule::scale;
    CHECK(centred.samples_per_epoch() == 3 * 13);
    setup.how.augmentation = augmentation_rule::sixfold;
    training six = setup.begin();
    CHECK(six.samples_per_epoch() == 6 * centred.samples_per_epoch());
}

TEST_CASE("trainer: a network that takes counts wants them scaled, for it knows their scale") {
    toy_setup setup{13};
    using of_counts = network<support::toy_task::size, square_root<>, dense<3>>;
    setup.how.input = input_rule::scale;
    CHECK(trainer<of_counts>(setup.how, setup.task.images(), split_of(setup.task), 1, setup.threads)
              .input_normalisation()
              .scale == 1.0f / 255);
    setup.how.input = input_rule::subtract_mean;
    CHECK_THROWS_WITH_AS(
        trainer<of_counts>(setup.how, setup.task.images(), split_of(setup.task), 1, setup.threads),
        "trainer: expected input_rule::scale for a network that takes counts, found "
        "input_rule::subtract_mean",
        std::invalid_argument);
    setup.how.input = input_rule::counts;
    CHECK_THROWS_WITH_AS(
        trainer<of_counts>(setup.how, setup.task.images(), split_of(setup.task), 1, setup.threads),
        "trainer: expected input_rule::scale for a network that takes counts, found "
        "input_rule::counts",
        std::invalid_argument);
}

TEST_CASE("trainer: refuses a split without training images") {
    toy_setup setup{4};
    CHECK_THROWS_AS(setup.begin(data_split{{}, {0}, {1}}), std::invalid_argument);
}

TEST_CASE("trainer: refuses the split of other images, whatever part of it does not fit") {
    toy_setup setup{4};
    const char* const error = "images: expected indices below 12 in the split, found 12";
    CHECK_NOTHROW(setup.begin(data_split{{0, 10}, {11}, {}}));
    CHECK_THROWS_WITH_AS(setup.begin(data_split{{0, 11}, {}, {11}}),
                         "split: expected sample 11 in one part, found it in training and in test",
                         std::invalid_argument);
    CHECK_THROWS_WITH_AS(setup.begin(data_split{{0, 12}, {1}, {}}), error, std::invalid_argument);
    CHECK_THROWS_WITH_AS(setup.begin(data_split{{0}, {12}, {}}), error, std::invalid_argument);
    const std::vector<std::size_t> test{12};
    CHECK_THROWS_WITH_AS(static_cast<void>(evaluate(net(), {}, setup.task.images(), test, setup.threads)),
                         error, std::invalid_argument);
}

TEST_CASE("trainer: images that do not fit the network are refused, in training and in evaluation") {
    toy_setup setup{5};
    const auto refused = [&](const labelled_images& images, recipe how = quick()) {
        CHECK_THROWS_AS(training(how, images, split_of(setup.task), 1, setup.threads), std::invalid_argument);
        if (how.validate_every > 0)
            CHECK_THROWS_AS(static_cast<void>(evaluate(net(), {}, images, {}, setup.threads)),
                            std::invalid_argument);
    };
    refused({setup.task.pixels, setup.task.labels, 4}); // more classes than outputs
    refused({setup.task.pixels, setup.task.labels, 2}); // a label that is no class
    refused({setup.task.pixels, setup.task.labels, 0});
    refused({std::span(setup.task.pixels).first(setup.task.pixels.size() - 1), setup.task.labels, 3});
    recipe never = quick();
    never.validate_every = 0;
    refused(setup.task.images(), never);
    CHECK_NOTHROW(setup.begin());
    setup.how.epochs = static_cast<std::size_t>(-5);
    CHECK_THROWS_WITH_AS(
        setup.begin(),
        ("trainer: expected at most 1000000000 epochs, found " + std::to_string(setup.how.epochs)).c_str(),
        std::invalid_argument);
}

TEST_CASE("trainer: a model has the names of all classes, or none yet") {
    toy_setup setup{4};
    const training t = setup.begin();
    CHECK(t.trained({}).classes.empty());
    CHECK(t.trained({"a", "b", "c"}).classes.size() == 3);
    CHECK_THROWS_WITH_AS(static_cast<void>(t.trained({"a", "b"})),
                         "trained: expected the names of all 3 classes of the samples, or none, found 2",
                         std::invalid_argument);
    CHECK_THROWS_AS(static_cast<void>(t.trained({"a", "b", "c", "d"})), std::invalid_argument);
}
