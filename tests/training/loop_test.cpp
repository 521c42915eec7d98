#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/loop.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <support/same_bits.hpp>
#include <training/toy_task.hpp>
#include <utility>
#include <vector>

// trainer_test.cpp tests the training itself, through a network whose type is known.

using namespace tactnet;

namespace {

using net = network<support::toy_task::size, conv2d<4, 3>, batch_norm, relu, max_pool<4>, dense<3>>;

struct toy_setup {
    support::toy_task task{20};
    thread_pool threads;
    recipe how = [] {
        recipe quick;
        quick.epochs = 2;
        quick.batch = 16;
        return quick;
    }();
    data_split split = split_data(task.labels, 3, split_rule::random, 1);

    training_loop begin(const labelled_samples& samples) {
        return {std::make_unique<trainable_network<net>>(), how, samples, split, 1, threads};
    }
    training_loop begin() { return begin(task.images()); }
};

} // namespace

TEST_CASE("training_loop: begins with the arrays of another network, all but those that are its own") {
    toy_setup setup;
    setup.how.pretrained_rate = 0;
    setup.how.averaging = 0.5;
    const std::vector<parameter> parameters = net::describe();
    std::vector<std::vector<float>> arrays;
    for (const parameter& p : parameters)
        arrays.push_back(p.name.starts_with("fc")
                             ? std::vector<float>()
                             : std::vector<float>(p.size, p.role == parameter_role::weight ? 0.25F : 0.5F));
    const auto values_of = [](const trainable& network, const parameter& p) {
        const net& own = static_cast<const trainable_network<net>&>(network).network();
        return (learnable(p.role) ? own.learnable_values() : own.running_statistics())
            .subspan(p.offset, p.size);
    };

    training_loop loop = setup.begin(), other = setup.begin();
    loop.start_from_trunk(arrays);
    for (const trainable* each : {&loop.latest(), &loop.best()})
        for (std::size_t i = 0; i < arrays.size(); ++i)
            CHECK(support::same_bits(values_of(*each, parameters[i]),
                                     arrays[i].empty() ? values_of(other.best(), parameters[i])
                                                       : std::span<const float>(arrays[i])));
    while (!loop.finished())
        loop.run_epoch();
    // At no share of the rate what was learnt stays, apart from what is measured.
    for (std::size_t i = 0; i < arrays.size(); ++i)
        if (learnable(parameters[i].role))
            CHECK(support::same_bits(values_of(loop.latest(), parameters[i]), arrays[i]) ==
                  !arrays[i].empty());
    CHECK_THROWS_AS(loop.start_from_trunk(arrays), std::logic_error);

    // A share of one is as another network's arrays at the full rate.
    setup.how.pretrained_rate = 1;
    training_loop shared = setup.begin(), whole = setup.begin();
    shared.start_from_trunk(arrays);
    const net& begun = static_cast<const trainable_network<net>&>(shared.latest()).network();
    whole.start_from(begun.learnable_values(), begun.running_statistics());
    shared.run_epoch(), whole.run_epoch();
    for (const parameter& p : parameters)
        CHECK(support::same_bits(values_of(shared.latest(), p), values_of(whole.latest(), p)));

    arrays[0].pop_back();
    CHECK_THROWS_WITH_AS(setup.begin().start_from_trunk(arrays),
                         "trainer: expected 36 numbers in conv1.weight, found 35", std::invalid_argument);
    arrays.pop_back();
    CHECK_THROWS_AS(setup.begin().start_from_trunk(arrays), std::invalid_argument);
}

TEST_CASE("training_loop: networks of a type that it does not know") {
    toy_setup setup;
    setup.how.epochs = 3;
    training_loop loop = setup.begin();
    while (!loop.finished())
        loop.run_epoch();
    REQUIRE(loop.mean().size() == support::toy_task::size.size());

    // What the best network does, by its type and without.
    const net& best = static_cast<const trainable_network<net>&>(loop.best()).network();
    normalisation<net::input_shape> normalise;
    std::copy(loop.mean().begin(), loop.mean().end(), normalise.mean.begin());
    normalise.scale = loop.scale();
    const evaluation typed = evaluate(best, normalise, setup.task.images(), setup.split.test, setup.threads);
    const evaluation any = evaluate(loop.best(), loop.mean(), loop.scale(), setup.task.images(),
                                    setup.split.test, setup.threads);
    CHECK(typed.loss == any.loss);
    CHECK(typed.recognised == any.recognised);
    CHECK(typed.confusion.total() == setup.split.test.size());

    // The mean over reflections is the same whichever way round the images come, and not that of one way.
    const evaluation reflected = evaluate(best, normalise, setup.task.images(), setup.split.test,
                                          setup.threads, test_time_augmentation::reflections);
    CHECK(reflected.loss != typed.loss);
    std::vector<std::uint8_t> turned(setup.task.pixels.size());
    for (std::size_t image = 0; image < setup.task.labels.size(); ++image)
        reflect_image(net::input_shape, {.rows = true, .columns = true},
                      setup.task.pixels.data() + image * net::input_shape.size(),
                      turned.data() + image * net::input_shape.size());
    const labelled_images other_way{turned, setup.task.labels, 3};
    const evaluation again = evaluate(loop.best(), loop.mean(), loop.scale(), other_way, setup.split.test,
                                      setup.threads, test_time_augmentation::reflections);
    CHECK(again.loss == reflected.loss);
    CHECK(again.recognised == reflected.recognised);

    // A copy is another network.
    const std::unique_ptr<trainable> copy = loop.best().copy();
    CHECK(support::same_bits(copy->learnable_values(), best.learnable_values()));
    copy->learnable_values()[0] += 1;
    CHECK(copy->learnable_values()[0] != best.learnable_values()[0]);
    CHECK_THROWS_AS(loop.start_from(copy->learnable_values(), copy->running_statistics()), std::logic_error);
    // Arrays of another network.
    CHECK_THROWS_AS(copy->copy_from(copy->learnable_values().first(3), copy->running_statistics()),
                    std::invalid_argument);
}

TEST_CASE("training_loop: features go to the network as they are") {
    toy_setup setup;
    setup.how.input = input_rule::scale;
    setup.how.augmentation = augmentation_rule::none;
    setup.how.remeasure_statistics = true;
    // How counts are scaled before a network, known in advance.
    std::vector<float> features;
    for (const std::uint8_t count : setup.task.pixels)
        features.push_back(static_cast<float>(count) * (1.0F / 255));
    const labelled_features found{features, setup.task.labels, 3};
    training_loop on_images = setup.begin();
    // Whatever is said of images.
    setup.how.input = input_rule::subtract_mean;
    setup.how.augmentation = augmentation_rule::sixfold;
    training_loop on_features = setup.begin(found);
    CHECK(on_features.samples_per_epoch() == setup.split.training.size());
    CHECK(on_features.scale() == 1);
    CHECK(std::count(on_features.mean().begin(), on_features.mean().end(), 0.0F) == 91);
    while (!on_images.finished()) {
        const epoch_report image = on_images.run_epoch(), feature = on_features.run_epoch();
        CHECK(image.loss == feature.loss);
        CHECK(image.validation_loss == feature.validation_loss);
    }
    CHECK(support::same_bits(on_images.best().copy()->learnable_values(),
                             on_features.best().copy()->learnable_values()));
    const evaluation by_images = evaluate(on_images.best(), on_images.mean(), on_images.scale(),
                                          setup.task.images(), setup.split.test, setup.threads),
                     by_features = evaluate(on_features.best(), on_features.mean(), on_features.scale(),
                                            found, setup.split.test, setup.threads);
    CHECK(by_images.loss == by_features.loss);
    CHECK(by_images.recognised == by_features.recognised);
}

TEST_CASE(
    "training_loop: sharpness-aware gradients teach something else, the same on any number of threads") {
    const auto trained = [](double radius, std::size_t threads) {
        toy_setup setup{.threads = thread_pool(threads)};
        setup.how.sharpness_radius = radius;
        training_loop loop = setup.begin();
        const double first_loss = loop.run_epoch().loss;
        CHECK(std::isfinite(first_loss));
        loop.run_epoch();
        const auto copy = loop.latest().copy();
        std::vector<float> all(copy->learnable_values().begin(), copy->learnable_values().end());
        all.insert(all.end(), copy->running_statistics().begin(), copy->running_statistics().end());
        return all;
    };
    const std::vector<float> perturbed = trained(0.1, 1);
    CHECK(perturbed != trained(0, 1));
    CHECK(perturbed == trained(0.1, 2));
    // So near that single precision does not see it: as without.
    CHECK(trained(1e-60, 1) == trained(0, 1));
}

TEST_CASE("training_loop: keeps the last network if the recipe demands it") {
    toy_setup setup;
    setup.how.epochs = 12;
    setup.how.rate = 0.3; // at which the loss goes up and down
    setup.how.schedule = constant_rate{};
    const auto keeps_latest = [&](bool keeps_last) {
        setup.how.keeps_last = keeps_last;
        training_loop loop = setup.begin();
        std::size_t times = 0;
        while (!loop.finished()) {
            loop.run_epoch();
            times += static_cast<std::size_t>(support::same_bits(loop.best().copy()->learnable_values(),
                                                                 loop.latest().copy()->learnable_values()));
        }
        return times;
    };
    CHECK(keeps_latest(true) == 12);
    CHECK(keeps_latest(false) < 12);
}

TEST_CASE("training_loop: features that are not finite are refused") {
    toy_setup setup;
    std::vector<float> features(setup.task.pixels.size(), 0.5F);
    const labelled_features found{features, setup.task.labels, 3};
    CHECK_NOTHROW(setup.begin(found));
    features[net::input_shape.size() + 3] = std::numeric_limits<float>::infinity();
    CHECK_THROWS_WITH_AS(setup.begin(found),
                         "features: expected a finite number in sample 1, feature 3, found inf",
                         std::invalid_argument);
}

TEST_CASE("training_loop: every number of a recipe that is outside of its range is refused, with its name") {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    toy_setup setup;
    const recipe right = setup.how;
    const auto refuses = [&](const std::string& what, std::initializer_list<double> numbers, auto set) {
        for (const double number : numbers) {
            setup.how = right;
            set(setup.how, number);
            CHECK_THROWS_WITH_AS(
                setup.begin(),
                ("trainer: expected a recipe's " + what + ", found " + std::to_string(number)).c_str(),
                std::invalid_argument);
        }
    };
    for (const auto& [name, member] :
         {std::pair("rate", &recipe::rate), std::pair("pretrained_rate", &recipe::pretrained_rate),
          std::pair("sharpness_radius", &recipe::sharpness_radius)})
        refuses(name + std::string(" of 0 or more, finite"), {-1, nan, inf},
                [m = member](recipe& how, double x) { how.*m = x; });
    using ranges = augmentation_ranges;
    for (const auto& [name, member] :
         {std::pair("translation", &ranges::translation), std::pair("rotation", &ranges::rotation),
          std::pair("scale", &ranges::scale), std::pair("pressure", &ranges::pressure),
          std::pair("shear", &ranges::shear)})
        refuses("ranges." + std::string(name) + " of 0 or more, finite", {-1, nan, inf},
                [m = member](recipe& how, double x) { how.ranges.*m = x; });
    for (const auto& [name, member] :
         {std::pair("reflect_rows", &ranges::reflect_rows),
          std::pair("reflect_columns", &ranges::reflect_columns), std::pair("erase", &ranges::erase)})
        refuses("ranges." + std::string(name) + " from 0 to 1", {-1, nan, 1.5},
                [m = member](recipe& how, double x) { how.ranges.*m = x; });
    refuses("ranges.noise.additive of 0 or more, finite", {-1, nan, inf},
            [](recipe& how, double x) { how.ranges.noise.additive = x; });
    refuses("ranges.noise.relative of 0 or more, finite", {-1, nan, inf},
            [](recipe& how, double x) { how.ranges.noise.relative = x; });
    const std::string share = " of 0 or more and below 1", positive = " above 0, finite",
                      finite = " of 0 or more, finite";
    refuses("label_smoothing" + share, {-0.1, nan, 1, 2},
            [](recipe& how, double x) { how.label_smoothing = x; });
    refuses("averaging" + share, {-1, nan, 1}, [](recipe& how, double x) { how.averaging = x; });
    refuses("epsilon" + positive, {0, nan, inf}, [](recipe& how, double x) { how.epsilon = x; });
    refuses("momentum" + share, {-1, nan, 1},
            [](recipe& how, double x) { how.optimiser = sgd{.momentum = x}; });
    refuses("l2" + finite, {-1, nan, inf}, [](recipe& how, double x) { how.optimiser = sgd{.l2 = x}; });
    refuses("beta1" + share, {-1, nan, 1}, [](recipe& how, double x) { how.optimiser = adamw{.beta1 = x}; });
    refuses("beta2" + share, {-1, nan, 1}, [](recipe& how, double x) { how.optimiser = adamw{.beta2 = x}; });
    refuses("decay" + finite, {-1, nan, inf},
            [](recipe& how, double x) { how.optimiser = adamw{.decay = x}; });
    refuses("optimiser.epsilon" + positive, {0, nan, inf},
            [](recipe& how, double x) { how.optimiser = adamw{.epsilon = x}; });
    refuses("drop period" + positive, {0, nan, inf},
            [](recipe& how, double x) { how.schedule = step_drop{.period = x}; });
    refuses("drop factor" + finite, {-1, nan, inf},
            [](recipe& how, double x) { how.schedule = step_drop{.factor = x}; });
    refuses("warm_up" + share, {-1, nan, 1},
            [](recipe& how, double x) { how.schedule = one_cycle{.warm_up = x}; });
    refuses("initial deviation" + finite, {-1, nan, inf},
            [](recipe& how, double x) { how.initialisation = fixed_normal{x}; });
    setup.how = right;
    setup.how.label_smoothing = 0.99;
    CHECK_NOTHROW(setup.begin());
}

TEST_CASE(
    "training_loop: gradients whose squares are not finite end it, for their numbers would move no more") {
    using head = network<shape{1, 1, 4}, dense<2>>;
    thread_pool threads;
    recipe how;
    how.batch = 8;
    how.augmentation = augmentation_rule::none;
    std::vector<float> features(16 * 4);
    std::vector<std::size_t> labels(16);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        labels[i] = i % 2;
        features[4 * i + labels[i]] = 1e25F;
    }
    training_loop loop(
        std::make_unique<trainable_network<head>>(), how, labelled_features{features, labels, 2},
        data_split{{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, {}, {}}, 1, threads);
    CHECK_THROWS_AS(loop.run_epoch(), training_diverged);
}

TEST_CASE("training_loop: the running average begins as a plain mean, so that it forgets its start") {
    toy_setup setup;
    setup.how.epochs = recipe().epochs;
    setup.how.batch = 0; // one step an epoch
    const auto values_after = [&](double averaging, std::size_t epochs) {
        setup.how.averaging = averaging;
        training_loop loop = setup.begin();
        for (std::size_t e = 0; e < epochs; ++e)
            loop.run_epoch();
        const auto copy = loop.latest().copy();
        return std::vector<float>(copy->learnable_values().begin(), copy->learnable_values().end());
    };
    const std::vector<float> begin = values_after(0, 0), first = values_after(0, 1),
                             second = values_after(0, 2), averaged = values_after(0.9, 2),
                             fixed = values_after(0.1, 2);
    REQUIRE(begin != first);
    for (std::size_t i = 0; i < begin.size(); ++i) {
        // The share of the past is (1 + steps) / (10 + steps), at most what the recipe says.
        const auto blended = [&](double one, double two) {
            const double once =
                one * static_cast<double>(begin[i]) + (1 - one) * static_cast<double>(first[i]);
            return two * once + (1 - two) * static_cast<double>(second[i]);
        };
        CHECK(static_cast<double>(averaged[i]) == doctest::Approx(blended(2.0 / 11, 3.0 / 12)).epsilon(1e-5));
        CHECK(static_cast<double>(fixed[i]) == doctest::Approx(blended(0.1, 0.1)).epsilon(1e-5));
    }
}
