#include <tactnet/runtime/random.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/svm/probability.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace tactnet;

TEST_CASE("feature_rows: whole rows only, of the number of features that the type says") {
    const std::vector<float> values(12);
    CHECK(feature_rows<4>(values).size() == 3);
    CHECK(feature_rows<>(values, 6).size() == 2);
    CHECK_THROWS_AS((feature_rows<5>{values}), std::invalid_argument);
    CHECK_THROWS_AS((feature_rows<4>{values, 6}), std::invalid_argument);
    CHECK_THROWS_AS((feature_rows<>{values, 0}), std::invalid_argument);
}

TEST_CASE("for_each_block: every row once and in order, in blocks of no more bytes than there may be") {
    for (const std::size_t rows : {0u, 1u, 2u, 63u, 1000u})
        for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{1} << 20U,
                                        (std::size_t{1} << 24U) - 1, std::size_t{1} << 40U}) {
            std::vector<float> values(rows * 3);
            const float* next = values.data();
            detail::for_each_block(feature_rows<3>(values), bytes, [&](feature_rows<3> block) {
                CHECK(block.values().data() == next);
                CHECK(block.size() > 0);
                CHECK((block.size() == 1 || block.size() * bytes <= std::size_t{1} << 24U));
                next += block.values().size();
            });
            CHECK(next == values.data() + values.size());
        }
}

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

TEST_CASE("probability: a sigmoid is found again from draws that it made") {
    const platt_sigmoid truth{-1.5, 0.7};
    random_stream random(1, random_purposes::order);
    std::vector<double> values, sides;
    for (std::size_t i = 0; i < 20'000; ++i) {
        values.push_back(random.uniform(-4, 4));
        sides.push_back(random.uniform() < truth.probability(values.back()) ? 1 : -1);
    }
    const platt_sigmoid found = fit_platt_sigmoid(values, sides);
    // The inverse of the information matrix of so many draws gives deviations of about 0.03.
    CHECK(std::abs(found.slope - truth.slope) < 0.1);
    CHECK(std::abs(found.offset - truth.offset) < 0.1);
    // At the maximum the targets' and the probabilities' moments agree.
    const double many = static_cast<double>(std::count(sides.begin(), sides.end(), 1.0));
    const double high = (many + 1) / (many + 2), low = 1 / (20'000 - many + 2);
    double g1 = 0, g2 = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double d = (sides[i] > 0 ? high : low) - found.probability(values[i]);
        g1 += values[i] * d;
        g2 += d;
    }
    CHECK(std::abs(g1) < 1e-4);
    CHECK(std::abs(g2) < 1e-4);
}

TEST_CASE("probability: useless values, and perfect ones, give finite sigmoids; no exponential overflows") {
    const std::vector<double> sides{1, 1, -1, -1};
    const platt_sigmoid nothing = fit_platt_sigmoid(std::vector<double>{0, 0, 0, 0}, sides);
    CHECK(nothing.probability(0) == doctest::Approx(0.5).epsilon(1e-3));
    const platt_sigmoid all = fit_platt_sigmoid(std::vector<double>{1e6, 2e6, -1e6, -2e6}, sides);
    CHECK(std::isfinite(all.slope));
    CHECK(all.probability(1e6) > 0.5);
    CHECK(all.probability(-1e6) < 0.5);
    CHECK(platt_sigmoid{1, 0}.probability(1e5) == 0);
    CHECK(platt_sigmoid{1, 0}.probability(-1e5) == 1);
}

TEST_CASE("probability: coupling finds probabilities that the pairs agree on") {
    const std::vector<double> truth{0.5, 0.3, 0.15, 0.05};
    std::vector<double> pairwise(16);
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            if (i != j)
                pairwise[i * 4 + j] = truth[i] / (truth[i] + truth[j]);
    const std::vector<double> found = couple_pairwise(pairwise, 4);
    CHECK(std::accumulate(found.begin(), found.end(), 0.0) == doctest::Approx(1));
    for (std::size_t i = 0; i < 4; ++i)
        CHECK(std::abs(found[i] - truth[i]) < 0.01); // the iteration ends at 0.005 / classes
}

TEST_CASE("probability: pairs that are certain couple to a certain class, not to NaN") {
    const std::vector<double> certain{0, 1, 1, 0, 0, 1, 0, 0, 0};
    const std::vector<double> found = couple_pairwise(certain, 3);
    CHECK(found[0] > 0.99);
    CHECK(std::accumulate(found.begin(), found.end(), 0.0) == doctest::Approx(1));
}

} // namespace
