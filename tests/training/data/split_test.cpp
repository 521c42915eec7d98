#include <tactnet/training/data/split.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

using namespace tactnet;

namespace {

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

} // namespace

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
