#include <tactnet/tensor/batch.hpp>
#include <tactnet/training/data/sample_batch.hpp>
#include <tactnet/training/data/split.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace tactnet;

TEST_CASE("sample_batch: is empty by default") {
    CHECK(sample_batch(6).samples() == 0);
    CHECK(sample_batch(6).elements().empty());
}

TEST_CASE("sample_batch: lies in memory as a batch of the same size") {
    constexpr shape size{2, 3, 1};
    for (const std::size_t samples : {1u, 5u, 17u, 40u}) {
        sample_batch found(size.size(), samples);
        batch<float, size, kernels::lanes<float>> expected(samples);
        REQUIRE(found.samples() == samples);
        REQUIRE(found.size() == size.size());
        for (std::size_t i = 0; i < samples; ++i) {
            std::array<float, size.size()> values;
            for (std::size_t e = 0; e < values.size(); ++e)
                values[e] = static_cast<float>(100 * i + e + 1);
            found.set(i, values);
            for (std::size_t e = 0; e < values.size(); ++e) {
                expected(i, e) = values[e];
                CHECK(found(i, e) == values[e]);
            }
        }
        const auto view = expected.as_const();
        CHECK(std::equal(view.data(), view.data() + view.lane_blocks() * view.lane_block_size, found.data()));
        found.resize(samples); // zero again
        CHECK(std::all_of(found.data(), found.data() + view.lane_blocks() * view.lane_block_size,
                          [](float v) { return v == 0; }));
    }
}

TEST_CASE("normalised_batch: counts as they are, less the mean of the chosen images, and scaled") {
    const std::array<std::uint8_t, 6> pixels{10, 20, 7, 255, 13, 0};
    const std::array<std::size_t, 2> chosen{0, 2};
    thread_pool alone;
    normalised_batch batch(2, alone);
    const auto fill = [&] {
        batch.fill(3, [&](std::size_t i, std::span<float> counts) {
            for (std::size_t e = 0; e < counts.size(); ++e)
                counts[e] = static_cast<float>(pixels[2 * i + e]);
        });
    };
    fill();
    REQUIRE(batch.samples().samples() == 3);
    CHECK(batch.samples()(1, 1) == 255);
    batch.subtract_mean(pixels, chosen);
    CHECK(batch.mean()[0] == 11.5F);
    CHECK(batch.mean()[1] == 10);
    fill();
    CHECK(batch.samples()(0, 0) == -1.5F);
    CHECK(batch.samples()(1, 1) == 245);
    batch.scale_by(2);
    CHECK(batch.scale() == 2);
    fill();
    CHECK(batch.samples()(2, 0) == 3);
    CHECK(batch.samples()(2, 1) == -20);
}

TEST_CASE("normalised_batch: the same on any number of threads, each image once") {
    constexpr std::size_t size = 5, count = 37;
    thread_pool alone, several(3);
    normalised_batch one(size, alone), many(size, several);
    const auto make = [](std::size_t i, std::span<float> counts) {
        for (std::size_t e = 0; e < counts.size(); ++e)
            counts[e] = static_cast<float>(i * 7 + e);
    };
    one.scale_by(1.0F / 255), many.scale_by(1.0F / 255);
    one.fill(count, make);
    std::array<const float*, count> at{}; // where each image was made
    many.fill(count, [&](std::size_t i, std::span<float> counts) {
        at[i] = counts.data();
        make(i, counts);
    });
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t t = 0; t < several.threads(); ++t) {
            const thread_pool::share share{t, several.threads()};
            // No two threads at one place, where they would write into each other's images.
            CHECK((i >= share.begin(count) && i < share.end(count)) == (at[i] == at[share.begin(count)]));
        }
    REQUIRE(many.samples().samples() == count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t e = 0; e < size; ++e) {
            CHECK(one.samples()(i, e) == static_cast<float>(i * 7 + e) * (1.0F / 255));
            CHECK(many.samples()(i, e) == one.samples()(i, e));
        }
}

/// `each` images of every class, class after class.
std::vector<std::size_t> labels_of(std::size_t classes, std::size_t each) {
    std::vector<std::size_t> labels;
    for (std::size_t c = 0; c < classes; ++c)
        labels.insert(labels.end(), each, c);
    return labels;
}
bool operator==(const data_split& a, const data_split& b) {
    return a.training == b.training && a.validation == b.validation && a.test == b.test;
}
void check_complete(const data_split& split, std::size_t count) {
    std::vector<int> seen(count);
    for (const auto* part : {&split.training, &split.validation, &split.test})
        for (const std::size_t i : *part)
            ++seen.at(i);
    CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}

TEST_CASE("split_data: 32, 8 and 10 of every 50, each image once") {
    const auto labels = labels_of(22, 50);
    for (const split_rule rule : {split_rule::random, split_rule::blocked})
        for (const std::uint64_t seed : {0u, 1u, 19u}) {
            const data_split split = split_data(labels, 22, rule, seed);
            check_complete(split, 1100);
            for (std::size_t c = 0; c < 22; ++c) {
                const auto of_class = [&](const std::vector<std::size_t>& part) {
                    return std::count_if(part.begin(), part.end(),
                                         [&](std::size_t i) { return labels[i] == c; });
                };
                CHECK(of_class(split.training) == 32);
                CHECK(of_class(split.validation) == 8);
                CHECK(of_class(split.test) == 10);
            }
            CHECK(split == split_data(labels, 22, rule, seed));
            CHECK(!(split == split_data(labels, 22, rule, seed + 1)));
        }
}

TEST_CASE("split_data: classes mixed in the list, and of unlike sizes") {
    std::vector<std::size_t> labels;
    for (std::size_t i = 0; i < 90; ++i)
        labels.push_back(i % 3 == 0 ? 0 : i % 10 == 1 ? 2 : 1);
    for (const split_rule rule : {split_rule::random, split_rule::blocked})
        check_complete(split_data(labels, 3, rule, 1), 90);
}

TEST_CASE("split_data: blocked keeps neighbours together") {
    const auto labels = labels_of(4, 50);
    bool moved = false;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const data_split split = split_data(labels, 4, split_rule::blocked, seed);
        for (std::size_t c = 0; c < 4; ++c) {
            // Around the circle of a class's images, test and validation are one run each, the one behind the
            // other.
            std::vector<char> part(50, 't');
            for (const std::size_t i : split.test)
                if (labels[i] == c)
                    part[i - 50 * c] = 'x';
            for (const std::size_t i : split.validation)
                if (labels[i] == c)
                    part[i - 50 * c] = 'v';
            std::size_t borders = 0;
            for (std::size_t i = 0; i < 50; ++i) {
                borders += part[i] != part[(i + 1) % 50];
                if (part[i] == 'x' && part[(i + 1) % 50] != 'x')
                    CHECK(part[(i + 1) % 50] == 'v');
            }
            CHECK(borders == 3);
            moved = moved || part[0] != 'x';
        }
    }
    CHECK(moved);
}

TEST_CASE("split_data: random does not keep neighbours together") {
    const auto labels = labels_of(1, 50);
    const data_split split = split_data(labels, 1, split_rule::random, 1);
    std::vector<std::size_t> test = split.test;
    std::sort(test.begin(), test.end());
    CHECK(test.back() - test.front() > 10);
}

TEST_CASE("split_data: few images and other shares") {
    for (const std::size_t each : {3u, 4u, 5u}) {
        const data_split split = split_data(labels_of(2, each), 2, split_rule::random, 1);
        CHECK(split.test.size() == 2);
        CHECK(split.validation.size() == 2);
        CHECK(split.training.size() == 2 * (each - 2));
    }
    const data_split most =
        split_data(labels_of(2, 3), 2, split_rule::random, 1, {.validation = 0, .test = 0.99});
    CHECK(most.training.size() == 2); // one of three is kept for training, however few there are
    const data_split all =
        split_data(labels_of(2, 10), 2, split_rule::random, 1, {.validation = 0, .test = 0});
    CHECK(all.training.size() == 20);
    const data_split none =
        split_data(labels_of(2, 10), 2, split_rule::random, 1, {.validation = 0.5, .test = 0.5});
    CHECK(none.training.size() == 2); // one of each class, whatever the shares
    CHECK(split_data({}, 3, split_rule::random, 1).training.empty());
}

TEST_CASE("split_data: outliers are for training alone, and change nothing for others") {
    for (const split_rule rule : {split_rule::random, split_rule::blocked}) {
        std::vector<std::size_t> labels = labels_of(3, 10);
        const data_split without = split_data(labels, 3, rule, 5);
        labels.push_back(no_class);
        labels.push_back(no_class);
        data_split with = split_data(labels, 3, rule, 5);
        check_complete(with, labels.size());
        REQUIRE(with.training.size() == without.training.size() + 2);
        CHECK(with.training[with.training.size() - 2] == 30);
        CHECK(with.training.back() == 31);
        with.training.resize(without.training.size());
        CHECK(with == without);
    }
}

/// People in each class, four images of a person one after the other.
std::vector<std::size_t> people_of(std::size_t classes, std::size_t people) {
    std::vector<std::size_t> groups;
    for (std::size_t i = 0; i < classes * people * 4; ++i)
        groups.push_back(i / 4 % people);
    return groups;
}

TEST_CASE("split_data: a group is in one part alone, by about the shares") {
    const auto labels = labels_of(3, 52), groups = people_of(3, 13);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const data_split split = split_data(labels, 3, groups, split_rule::grouped, seed);
        check_complete(split, labels.size());
        CHECK_NOTHROW(check_split(split, labels, groups));
        CHECK(split.test.size() == 3 * 12); // three people of 13
        CHECK(split.validation.size() == 2 * 12);
        CHECK(split == split_data(labels, 3, groups, split_rule::grouped, seed));
    }
    CHECK(!(split_data(labels, 3, groups, split_rule::grouped, 0) ==
            split_data(labels, 3, groups, split_rule::grouped, 1)));
}

TEST_CASE("split_data: groups that have one class each, and classes of few groups") {
    // Five objects of class 0, two of class 1, one of class 2.
    const std::vector<std::size_t> objects{0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 6, 6, 6, 6, 7, 7};
    const std::vector<std::size_t> labels{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2};
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const data_split split = split_data(labels, 3, objects, split_rule::grouped, seed);
        check_complete(split, labels.size());
        CHECK_NOTHROW(check_split(split, labels, objects));
        const auto tested = [&](std::size_t label) {
            return std::any_of(split.test.begin(), split.test.end(),
                               [&](std::size_t i) { return labels[i] == label; });
        };
        CHECK(tested(0));
        CHECK(tested(1));
        CHECK(!tested(2)); // or training would lack it
    }
}

TEST_CASE("split_data: a class of large groups is tested, though each is more than its share") {
    const std::vector<std::size_t> labels(16), groups{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
    CHECK(split_data(labels, 1, groups, split_rule::grouped, 0).test.size() == 8);
}

TEST_CASE("split_data: folds by rule and seed") {
    const auto labels = labels_of(3, 52), groups = people_of(3, 13);
    for (const auto& [rule, folds] : {std::pair(split_rule::leave_one_group_out, std::size_t{13}),
                                      {split_rule::group_folds, 4},
                                      {split_rule::stratified_folds, 4}}) {
        std::vector<int> tested(labels.size());
        for (std::uint64_t seed = 0; seed < folds; ++seed) {
            const data_split split = split_data(labels, 3, groups, rule, seed, {}, folds);
            check_complete(split, labels.size());
            CHECK_NOTHROW(check_split(split, labels));
            CHECK((rule == split_rule::stratified_folds || !split.validation.empty()));
            for (const std::size_t i : split.test)
                ++tested[i];
            CHECK(split.test == split_data(labels, 3, groups, rule, seed + folds, {}, folds).test);
            if (needs_groups(rule))
                CHECK_NOTHROW(check_split(split, labels, groups));
            else
                CHECK(split.validation.size() == 24); // the share of all, of each class alike
        }
        CHECK(std::all_of(tested.begin(), tested.end(), [](int n) { return n == 1; }));
        CHECK(needs_groups(rule) == !(rule == split_rule::stratified_folds));
    }
    auto outliers = labels;
    outliers[7] = no_class;
    const data_split with = split_data(outliers, 3, groups, split_rule::leave_one_group_out, 1);
    CHECK(with.training.back() == 7);
    CHECK(std::find(with.test.begin(), with.test.end(), 7) == with.test.end());
    const data_split no_groups = split_data(labels, 3, {}, split_rule::blocked, 1);
    CHECK(no_groups == split_data(labels, 3, split_rule::blocked, 1));
    CHECK_THROWS_WITH((void)split_data(labels, 3, people_of(1, 13), split_rule::grouped, 1),
                      "split_data: expected the group of each of 156 samples, found 52 groups");
    CHECK_THROWS_AS((void)split_data(labels, 3, split_rule::grouped, 1), std::invalid_argument);
    CHECK_THROWS_AS((void)split_data(labels, 3, groups, split_rule::given, 1), std::invalid_argument);
}

TEST_CASE("check_split: what is on both sides, and what training lacks") {
    const std::vector<std::size_t> labels{0, 0, 0, 1, 1, 1}, groups{0, 1, 2, 0, 1, 2};
    const auto problem = [&](const data_split& split) -> std::string {
        try {
            check_split(split, labels, groups);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return {};
    };
    CHECK(problem({{0, 3, 3}, {1, 4}, {2, 5}}).empty());
    CHECK(problem({{0, 3}, {1}, {2, 3}}) ==
          "split: expected sample 3 in one part, found it in training and in test");
    CHECK(problem({{0, 4}, {1}, {2}}) ==
          "split: expected group 1 in one part, found it in training and in validation");
    CHECK(problem({{0}, {1}, {2, 5}}) ==
          "split: expected training samples of class 1, of which sample 5 is in test, found none");
    CHECK(problem({{0, 6}, {}, {}}) == "split: expected samples below 6, found 6");
}

TEST_CASE("part_of_training: a share of each class, or whole groups; validation and test stay") {
    std::vector<std::size_t> labels = labels_of(2, 50);
    labels.insert(labels.end(), 3, 2);
    const data_split whole = split_data(labels, 3, split_rule::random, 1); // 32, 32 and 1 to train
    std::vector<std::size_t> before;
    for (const auto& [share, kept] : {std::pair{0.01, 3u}, {0.25, 17u}, {0.5, 33u}, {1.0, 65u}}) {
        data_split part = part_of_training(whole, labels, {}, share, 5);
        CHECK(part.training.size() == kept);
        CHECK(std::ranges::includes(part.training, before));
        CHECK(!problem_of(part, labels));
        before = std::exchange(part.training, whole.training);
        CHECK(part == whole);
    }
    CHECK(std::ranges::is_permutation(whole.training, before));
    // It draws anew, not as the split of the same seed did, which shuffled these.
    const std::vector<std::size_t> one(40);
    const data_split every = split_data(one, 1, split_rule::random, 5, {.validation = 0, .test = 0});
    CHECK_FALSE(std::ranges::is_permutation(part_of_training(every, one, {}, 0.5, 5).training,
                                            std::span(every.training).first(20)));
    // Four people with every class: two of them for a half, and for a little more three.
    std::vector<std::size_t> all(40), people(40), postures(40);
    for (std::size_t i = 0; i < 40; ++i)
        all[i] = i, people[i] = i / 10, postures[i] = i % 2;
    for (const auto& [share, kept] : {std::pair{0.01, 10u}, {0.5, 20u}, {0.51, 30u}}) {
        const data_split part = part_of_training({all, {}, {}}, postures, people, share, 5);
        CHECK(part.training.size() == kept);
        for (const std::size_t i : part.training)
            CHECK(std::ranges::count(part.training, people[i], [&](std::size_t j) { return people[j]; }) ==
                  10);
    }
}

TEST_CASE("balanced: rare classes are repeated in turn") {
    const std::vector<std::size_t> labels{0, 0, 0, 0, 0, 1, 1, no_class};
    const data_split split = balanced({{0, 1, 2, 3, 4, 5, 6, 7}, {}, {}}, labels);
    CHECK(split.training == std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7, 5, 6, 5});
}

} // namespace
