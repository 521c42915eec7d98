#include <tactnet/svm/multiclass.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

using namespace tactnet;

TEST_CASE("multiclass: problems of pairs and of each class against the rest") {
    const std::vector<std::size_t> labels{9, 4, 9, 7}, all = all_samples(4);
    const class_members classes(labels, all);
    CHECK(classes.labels == std::vector<std::size_t>{4, 7, 9});
    const std::vector<double> costs{1, 2, 3};
    const auto pairs = binary_problems(classes, costs, multiclass::one_versus_one);
    REQUIRE(pairs.size() == machine_count(3, multiclass::one_versus_one));
    CHECK(pairs[1].samples == std::vector<std::size_t>{1, 0, 2}); // 4 against 9
    CHECK(pairs[1].sides == std::vector<double>{1, -1, -1});
    CHECK(pairs[1].costs == std::vector<double>{1, 3, 3});
    const auto rest = binary_problems(classes, costs, multiclass::one_versus_rest);
    REQUIRE(rest.size() == 3);
    CHECK(rest[2].samples == std::vector<std::size_t>{1, 3, 0, 2});
    CHECK(rest[2].sides == std::vector<double>{-1, -1, 1, 1});
}

TEST_CASE("multiclass: classes whose machines would not fit into memory are refused in words") {
    using tactnet::detail::require_training_memory;
    constexpr std::size_t four_gibibytes = 0xffff'ffff;
    CHECK_NOTHROW(require_training_memory(1000, 20'000, multiclass::one_versus_one, four_gibibytes));
    CHECK_NOTHROW(require_training_memory(22, 1'000'000, multiclass::one_versus_one, four_gibibytes));
    try {
        require_training_memory(10'000, 20'000, multiclass::one_versus_one, four_gibibytes);
        FAIL("nothing was thrown");
    } catch (const std::invalid_argument& error) {
        const std::string what = error.what();
        CAPTURE(what);
        CHECK(what.starts_with("support vector machines of 10000 classes from 20000 samples, one versus one: "
                               "expected to need at most " +
                               std::to_string(four_gibibytes) + " bytes of memory (memory_bytes), found "));
    }
    CHECK_THROWS_AS(require_training_memory(10'000, 20'000, multiclass::one_versus_rest, four_gibibytes),
                    std::invalid_argument);
    // A grid tries its costs at once and keeps the values of what was held out.
    CHECK_THROWS_AS(
        require_training_memory(1000, 20'000, multiclass::one_versus_one, four_gibibytes, 5, 4000),
        std::invalid_argument);
}

// Labels come more often than once, so that behind the classes found there is memory with labels in it: with
// the sanitizer this test sees a read of it, and without one the weight would be written behind the costs,
// over what the heap keeps of itself.
TEST_CASE("multiclass: a weight is for the costs of its class alone") {
    const std::vector<std::size_t> labels{3, 5, 8, 8, 8};
    const class_members classes(labels);
    REQUIRE(classes.labels == std::vector<std::size_t>{3, 5, 8});
    const std::vector<class_weight> weights{{8, 1e300}, {5, 0.5}, {7, 1e-3}};
    for (int again = 0; again < 3; ++again) {
        const std::vector<double> costs = class_costs(classes, 1e-300, weights);
        CHECK(costs == std::vector<double>{1e-300, 0.5e-300, 1e-300 * 1e300});
    }
    CHECK_THROWS_AS((void)class_costs(classes, 1, std::vector<class_weight>{{3, -1}}), std::invalid_argument);
    CHECK_THROWS_AS((void)class_costs(classes, 1e300, std::vector<class_weight>{{3, 1e300}}),
                    std::invalid_argument);
}

TEST_CASE("multiclass: most votes win, the first of equals; zero is a vote for the second of a pair") {
    CHECK(winning_class(std::array{1.0, 1.0, -1.0}, 3, multiclass::one_versus_one) == 0);
    CHECK(winning_class(std::array{-1.0, 1.0, -1.0}, 3, multiclass::one_versus_one) == 0); // one vote each
    CHECK(winning_class(std::array{-1.0, -1.0, 1.0}, 3, multiclass::one_versus_one) == 1);
    CHECK(winning_class(std::array{0.0}, 2, multiclass::one_versus_one) == 1);
    CHECK(winning_class(std::array{0.5, 2.0, 2.0}, 3, multiclass::one_versus_rest) == 1);
}

TEST_CASE("deal_folds: they hold about as many of each class, and are those of the seed") {
    std::vector<std::vector<std::size_t>> classes(3);
    for (std::size_t i = 0; i < 31; ++i)
        classes[i % 3].push_back(i);
    const std::vector<std::size_t> folds = deal_folds(classes, 31, 4, 1);
    for (const auto& members : classes)
        for (std::size_t f = 0; f < 4; ++f) {
            const auto count = std::count_if(members.begin(), members.end(),
                                             [&](std::size_t sample) { return folds[sample] == f; });
            CHECK(count >= 2);
            CHECK(count <= 3);
        }
    for (std::size_t f = 0; f < 4; ++f) { // and of all: the next class goes on where the last one ended
        const auto count = std::count(folds.begin(), folds.end(), f);
        CHECK(count >= 7);
        CHECK(count <= 8);
    }
    CHECK(folds == deal_folds(classes, 31, 4, 1));
    CHECK(folds != deal_folds(classes, 31, 4, 2));
}
