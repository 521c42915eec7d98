#include <tactnet/runtime/random.hpp>
#include <tactnet/svm/probability.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

using namespace tactnet;

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
