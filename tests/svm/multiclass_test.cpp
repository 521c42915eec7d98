#include "samples.hpp"

#include <tactnet/svm/folds.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/svm/probability.hpp>
#include <tactnet/svm/standardisation.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

using namespace tactnet;

TEST_SUITE("svm/multiclass") {
    TEST_CASE("problems of pairs and of each class against the rest") {
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

    TEST_CASE("most votes win, the first of equals; zero is a vote for the second of a pair") {
        CHECK(decide(std::array{1.0, 1.0, -1.0}, 3, multiclass::one_versus_one) == 0);
        CHECK(decide(std::array{-1.0, 1.0, -1.0}, 3, multiclass::one_versus_one) == 0); // one vote each
        CHECK(decide(std::array{-1.0, -1.0, 1.0}, 3, multiclass::one_versus_one) == 1);
        CHECK(decide(std::array{0.0}, 2, multiclass::one_versus_one) == 1);
        CHECK(decide(std::array{0.5, 2.0, 2.0}, 3, multiclass::one_versus_rest) == 1);
    }

    TEST_CASE("folds hold about as many of each class, and are those of the seed") {
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
}

TEST_SUITE("svm/probability") {
    TEST_CASE("a sigmoid is found again from draws that it made") {
        const sigmoid truth{-1.5, 0.7};
        random_stream random(1, draw::order);
        std::vector<double> values, sides;
        for (std::size_t i = 0; i < 20'000; ++i) {
            values.push_back(random.uniform(-4, 4));
            sides.push_back(random.uniform() < truth(values.back()) ? 1 : -1);
        }
        const sigmoid found = fit_sigmoid(values, sides);
        // The inverse of the information matrix of so many draws gives deviations of about 0.03.
        CHECK(std::abs(found.slope - truth.slope) < 0.1);
        CHECK(std::abs(found.offset - truth.offset) < 0.1);
        // At the maximum the targets' and the probabilities' moments agree.
        const double many = static_cast<double>(std::count(sides.begin(), sides.end(), 1.0));
        const double high = (many + 1) / (many + 2), low = 1 / (20'000 - many + 2);
        double g1 = 0, g2 = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double d = (sides[i] > 0 ? high : low) - found(values[i]);
            g1 += values[i] * d;
            g2 += d;
        }
        CHECK(std::abs(g1) < 1e-4);
        CHECK(std::abs(g2) < 1e-4);
    }

    TEST_CASE("values that tell nothing, or all, give finite sigmoids; no exponential overflows") {
        const std::vector<double> sides{1, 1, -1, -1};
        const sigmoid nothing = fit_sigmoid(std::vector<double>{0, 0, 0, 0}, sides);
        CHECK(nothing(0) == doctest::Approx(0.5).epsilon(1e-3));
        const sigmoid all = fit_sigmoid(std::vector<double>{1e6, 2e6, -1e6, -2e6}, sides);
        CHECK(std::isfinite(all.slope));
        CHECK(all(1e6) > 0.5);
        CHECK(all(-1e6) < 0.5);
        CHECK(sigmoid{1, 0}(1e5) == 0);
        CHECK(sigmoid{1, 0}(-1e5) == 1);
    }

    TEST_CASE("coupling finds probabilities that the pairs agree on") {
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
}

TEST_SUITE("svm/standardisation") {
    TEST_CASE("mean nought and deviation one; constant features are only centred") {
        support::samples s = support::blobs(1000, 3, 2, 2);
        for (std::size_t i = 0; i < 1000; ++i) {
            s.values[3 * i + 1] = 0.1F;
            s.values[3 * i + 2] = 1e15F * s.values[3 * i + 2] + 3e15F;
        }
        const standardisation fitted = standardisation::of(s.rows());
        CHECK(fitted.deviation[1] == 1);
        const std::vector<float> standard = fitted(s.rows());
        for (std::size_t f = 0; f < 3; ++f) {
            double mean = 0, squares = 0;
            for (std::size_t i = 0; i < 1000; ++i)
                mean += static_cast<double>(standard[3 * i + f]) / 1000;
            for (std::size_t i = 0; i < 1000; ++i)
                squares += std::pow(static_cast<double>(standard[3 * i + f]) - mean, 2) / 1000;
            CHECK(std::abs(mean) < 1e-6);
            CHECK(squares == doctest::Approx(f == 1 ? 0 : 1).epsilon(1e-5));
        }
        CHECK_THROWS_AS((void)fitted({s.values, 5}), std::invalid_argument);
        CHECK_THROWS_AS((void)standardisation::of({{}, 3}), std::invalid_argument);
    }
}

TEST_SUITE("svm/feature_rows") {
    TEST_CASE("whole rows only, of the number of features that the type says") {
        const std::vector<float> values(12);
        CHECK(feature_rows<4>(values).size() == 3);
        CHECK(feature_rows<>(values, 6).size() == 2);
        CHECK_THROWS_AS((feature_rows<5>{values}), std::invalid_argument);
        CHECK_THROWS_AS((feature_rows<4>{values, 6}), std::invalid_argument);
        CHECK_THROWS_AS((feature_rows<>{values, 0}), std::invalid_argument);
    }
}
