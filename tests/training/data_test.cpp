#include <tactnet/tensor/batch.hpp>
#include <tactnet/training/data/sample_batch.hpp>
#include <tactnet/training/data/split.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
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

} // namespace
