#include <tactnet/training/metrics.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

using namespace tactnet;

TEST_CASE("confusion_matrix: counts and the rates computed from them") {
    confusion_matrix m(3), n(3);
    CHECK(std::isnan(m.accuracy()));
    m.add(0, 0);
    m.add(1, 2);
    n.add(1, 2);
    n.add(2, 2);
    m.add(n);
    CHECK(m.count(0, 0) == 1);
    n.add(0, 0);
    m.add(n);
    CHECK(m.count(0, 0) == 2); // the first of all counts, too
    CHECK(m.count(1, 2) == 3);
    m = confusion_matrix(3);
    m.add(0, 0), m.add(1, 2), m.add(1, 2), m.add(2, 2);
    CHECK(m.count(1, 2) == 2);
    CHECK(m.count(2, 1) == 0);
    CHECK(m.total() == 4);
    CHECK(m.correct() == 2);
    CHECK(m.accuracy() == 0.5);
    CHECK(m.classes() == 3);
}

TEST_CASE("mean_and_deviation: of samples, of one and of none") {
    const auto m = mean_and_deviation::of(std::array{2.0, 4.0, 4.0, 6.0});
    CHECK(m.mean == doctest::Approx(4));
    CHECK(m.deviation == doctest::Approx(std::sqrt(8.0 / 3)));
    CHECK(mean_and_deviation::of(std::array{-1.0, 4.0}).deviation == doctest::Approx(std::sqrt(12.5)));
    CHECK(mean_and_deviation::of(std::array{3.0}).deviation == 0);
    CHECK(mean_and_deviation::of({}).mean == 0);
    // Twenty evaluations without a mistake are no better than that.
    CHECK(mean_and_deviation::of(std::vector<double>(20, 1.0)).mean == 1);
    CHECK(mean_and_deviation::of(std::vector<double>(20, 1.0)).deviation == 0);
    // Distances from the mean are squared, which are exact here, unlike differences of squares.
    CHECK(mean_and_deviation::of(std::array{1e17, 1e17 + 64, 1e17 + 128, 1e17 + 320}).deviation ==
          doctest::Approx(64 * std::sqrt(14.0 / 3)));
}
