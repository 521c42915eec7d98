#include <tactnet/io/model_file.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{8, 10};
using net = network<size, conv2d<4, 3>, batch_norm, relu, max_pool<2>, dense<3>>;

/// Spots near the top of the left, of the right, or in the middle, by four people with other gains. Upside
/// down they resemble no class if `tops`; else they are at half the height.
struct sides_task {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels, groups, all;

    explicit sides_task(bool tops) {
        for (std::size_t group = 0; group < 4; ++group)
            for (std::size_t label = 0; label < 3; ++label)
                for (std::uint32_t i = 0; i < 10; ++i) {
                    random_stream random(1, random_purposes::order,
                                         static_cast<std::uint32_t>(group * 3 + label), i);
                    const double row = (tops ? 1.2 : 3.5) + random.uniform(-0.5, 0.5),
                                 column = (label == 0   ? 1.5
                                           : label == 1 ? 7.5
                                                        : 4.5) +
                                          random.uniform(-0.7, 0.7);
                    for (std::size_t y = 0; y < size.rows; ++y)
                        for (std::size_t x = 0; x < size.columns; ++x) {
                            const double down = static_cast<double>(y) - row,
                                         right = static_cast<double>(x) - column;
                            pixels.push_back(
                                static_cast<std::uint8_t>((100 + 30 * static_cast<double>(group)) *
                                                          std::exp(-(down * down + right * right) / 2)));
                        }
                    all.push_back(labels.size());
                    labels.push_back(label);
                    groups.push_back(group);
                }
    }
    [[nodiscard]] labelled_images images() const { return {pixels, labels, 3}; }
};

const std::vector<std::size_t> exchanged{1, 0, 2};

} // namespace

TEST_CASE("find_reflections: partners along columns; rows only where reflected images show a class") {
    for (const bool tops : {true, false})
        for (const bool grouped : {true, false}) {
            CAPTURE(tops);
            CAPTURE(grouped);
            const sides_task task(tops);
            const std::vector<std::size_t> none;
            const reflection_rule found =
                find_reflections(size, task.images(), task.all, grouped ? task.groups : none);
            CHECK(found.columns.reflects);
            CHECK(found.columns.partners == exchanged);
            CHECK(found.rows.reflects == !tops);
            CHECK(found.rows.partners.empty());
        }
}

TEST_CASE("epoch_samples: a reflected image has the label of its partner, and averages exchange outputs") {
    const sides_task task(true);
    thread_pool threads(1);
    recipe how = recipe::default_for(size.rows, size.columns);
    how.epochs = 30;
    how.ranges = {.reflect_columns = 0.5};
    how.reflections = {{}, {true, exchanged}};
    trainer<net> training(how, task.images(), {task.all, {}, {}}, 1, threads);
    while (!training.finished())
        training.run_epoch();
    const auto correct = [&](const reflection_rule& rule) {
        return evaluate(training.latest(), training.input_normalisation(), task.images(), task.all, threads,
                        rule)
            .confusion.accuracy();
    };
    CHECK(correct({}) == 1);
    CHECK(correct(training.reflections()) == 1);
    CHECK(correct({{}, {true, {}}}) < 0.8);
    CHECK(training.reflections() == reflection_rule{{}, {true, exchanged}});
    const support::temporary_folder folder;
    save_model(folder / "net", training.trained({"left", "right", "middle"}));
    CHECK(load_model<net>(folder / "net").reflections == training.reflections());

    // With plain reflections, left and right are one.
    how.reflections = reflection_rule::all();
    trainer<net> plain(how, task.images(), {task.all, {}, {}}, 1, threads);
    while (!plain.finished())
        plain.run_epoch();
    CHECK(evaluate(plain.latest(), plain.input_normalisation(), task.images(), task.all, threads)
              .confusion.accuracy() < 0.9);
    how.augmentation = augmentation_rule::none;
    CHECK(how.learnt_reflections() == reflection_rule{});
}

TEST_CASE("choose_augmentation: finds partners, judges kinds on held-out groups, and says why") {
    const sides_task task(true);
    thread_pool threads(1);
    recipe how = recipe::default_for(size.rows, size.columns);
    how.epochs = 40;
    const std::vector<std::string> names{"left", "right", "middle"};
    const trainable_network<net> fresh;
    const auto choose = [&](const search_stop& stop = {}) {
        return choose_augmentation(fresh, how, task.images(), task.all, task.groups, 1, threads, names, stop);
    };
    const augmentation_choice found = choose();
    CHECK(found.chosen.ranges.reflect_rows == 0);
    CHECK(found.chosen.ranges.reflect_columns == 0.5);
    CHECK(found.chosen.reflections == reflection_rule{{}, {true, exchanged}});
    CHECK(found.trials.size() == 3); // without the rows, which are off by then
    REQUIRE(found.reasons.size() >= 2);
    CHECK(found.reasons[0] == "reflections of rows: off, since reflected images resemble no class");
    CHECK(found.reasons[1].ends_with(": left = right"));
    CHECK(found.chosen.epochs == how.epochs);
    CHECK(choose().chosen.ranges == found.chosen.ranges);
    CHECK(choose([](std::size_t, std::size_t) { return true; }).trials.empty());
    std::size_t last = 0, of = 0;
    (void)choose([&](std::size_t done, std::size_t all) {
        CHECK(done <= last + 1);
        CHECK(done >= last);
        CHECK((of == 0 || of == all));
        last = done, of = all;
        return false;
    });
    CHECK(last == of);
    CHECK(of == how.epochs / 2);

    // What a caller has decided is neither changed nor tried.
    const auto decided =
        choose_augmentation(fresh, how, task.images(), task.all, task.groups, 1, threads, names, {}, 220,
                            {.rows = true, .columns = true, .movement = true});
    CHECK(decided.chosen.reflections == reflection_rule::all());
    CHECK(decided.chosen.ranges.reflect_rows == how.ranges.reflect_rows);
    REQUIRE(decided.trials.size() == 1);
    CHECK(decided.trials[0].what == "with the square root of counts");

    const auto reasons = [&](std::size_t most, const std::vector<std::size_t>& groups) {
        return choose_augmentation(fresh, how, task.images(), task.all, groups, 1, threads, names, {}, most)
            .reasons;
    };
    // One group, or one of each class, is no group to compare with.
    for (const std::vector<std::size_t>& alone :
         {std::vector<std::size_t>(task.all.size(), 7), task.labels}) {
        const std::vector<std::string> told = reasons(0, alone);
        REQUIRE(told.size() == 3);
        CHECK(told[0] == "each class has one group, so parts of a class take their place");
        CHECK(std::ranges::equal(std::span(told).last(2), reasons(0, {})));
    }

    how.augmentation = augmentation_rule::none;
    CHECK(choose().trials.empty());
    CHECK(choose().chosen.ranges == how.ranges);
}

TEST_CASE("choose_augmentation: an interrupted search resumes bit-identically, without what is known") {
    const sides_task task(true);
    thread_pool threads(1);
    recipe how = recipe::default_for(size.rows, size.columns);
    how.epochs = 40;
    const trainable_network<net> fresh;
    trial_scores known;
    std::size_t asked = 0; // once an epoch, and at the end of a short training
    const auto choose = [&](std::size_t most) {
        asked = 0;
        return choose_augmentation(
            fresh, how, task.images(), task.all, task.groups, 1, threads, {},
            [&](std::size_t, std::size_t) { return asked++ >= most; }, 220, {}, &known);
    };
    const augmentation_choice whole = choose(1000);
    const trial_scores all = std::exchange(known, {});
    const std::size_t asked_in_all = asked, halfway = asked / 2;
    REQUIRE(all.size() == whole.trials.size() + 1);
    choose(halfway);
    const std::size_t done = known.size();
    CHECK((done > 0 && done < all.size()));
    for (const std::size_t repeated : {all.size() - done, std::size_t{0}}) {
        const augmentation_choice resumed = choose(1000);
        CHECK(asked == repeated * asked_in_all / all.size() + all.size() - repeated);
        CHECK(known == all);
        CHECK(resumed.chosen.ranges == whole.chosen.ranges);
        CHECK(resumed.chosen.function == whole.chosen.function);
        CHECK(resumed.reasons == whole.reasons);
    }
    known.back().pop_back();
    CHECK_THROWS_AS(choose(1000), std::invalid_argument);
}

TEST_CASE("scores_of: of each class of each group, or of four parts of it if there are few") {
    const sides_task task(true);
    evaluation found{0, confusion_matrix(3), {}, std::vector<float>(3 * task.all.size())};
    const auto count = [&](std::size_t judged, const std::vector<std::size_t>& groups) {
        return detail::scores_of(found, task.images(), std::span(task.all).first(judged), groups).size();
    };
    CHECK(count(120, task.groups) == 12);
    CHECK(count(30, task.groups) == 12); // one group, three classes
    CHECK(count(60, task.groups) == 6);
    CHECK(count(120, {}) == 12);
    CHECK(count(13, {}) == 7); // four of ten and three of three
}

TEST_CASE("choose_augmentation: samples, choices and groups that do not match are refused") {
    const sides_task task(false);
    std::vector<std::size_t> chosen = task.all, labels = task.labels, groups = task.groups;
    std::vector<std::uint8_t> pixels = task.pixels;
    SUBCASE("a label beyond the classes") {
        labels[7] = 900;
    }
    SUBCASE("an image less") {
        pixels.resize(pixels.size() - size.size());
    }
    SUBCASE("a sample that is not there") {
        chosen.push_back(labels.size());
    }
    SUBCASE("a group less") {
        groups.pop_back();
    }
    const labelled_images images{pixels, labels, 3};
    CHECK_THROWS_AS((void)find_reflections(size, images, chosen, groups), std::invalid_argument);
    thread_pool alone;
    CHECK_THROWS_AS((void)choose_augmentation(trainable_network<net>(),
                                              recipe::default_for(size.rows, size.columns), images, chosen,
                                              groups, 1, alone),
                    std::invalid_argument);
}

TEST_CASE("choose_augmentation: held-out samples are whole groups, or blocks of each class") {
    const sides_task task(true);
    const std::vector<std::size_t> none, training(task.all.begin() + 30, task.all.end());
    for (const bool grouped : {true, false}) {
        const data_split split = detail::hold_out(task.images(), training, grouped ? task.groups : none, 5);
        CHECK(split.training.size() + split.validation.size() == training.size());
        CHECK(split.test.empty());
        CHECK_FALSE(split.validation.empty());
        for (const std::size_t held : split.validation) {
            CHECK(held >= 30);
            if (grouped)
                CHECK(std::ranges::none_of(
                    split.training, [&](std::size_t i) { return task.groups[i] == task.groups[held]; }));
        }
    }
}
