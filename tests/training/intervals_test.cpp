#include <tactnet/training/intervals.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace tactnet;

TEST_CASE("confusion_matrix: recall, precision, F1 and balanced accuracy of unlike classes") {
    confusion_matrix m(4); // 4 of 5 right; 1 of 1; none of 2; a class that is never there
    for (const auto& [truth, recognised, count] :
         {std::array<std::size_t, 3>{0, 0, 4}, {0, 1, 1}, {1, 1, 1}, {2, 0, 2}})
        for (std::size_t i = 0; i < count; ++i)
            m.add(truth, recognised);
    CHECK(m.samples(0) == 5);
    CHECK(m.recognised(0) == 6);
    CHECK(m.recall(0) == 0.8);
    CHECK(m.precision(0) == doctest::Approx(4.0 / 6));
    CHECK(m.f1(0) == doctest::Approx(8.0 / 11));
    CHECK(m.precision(1) == 0.5);
    CHECK(m.f1(2) == 0);
    CHECK(std::isnan(m.precision(2)));
    CHECK(std::isnan(m.recall(3)));
    CHECK(m.balanced_accuracy() == doctest::Approx((0.8 + 1 + 0) / 3));
    CHECK(m.macro_f1() == doctest::Approx((8.0 / 11 + 2.0 / 3 + 0) / 3));
    CHECK(m.accuracy() == 5.0 / 8);
    CHECK(std::isnan(confusion_matrix(3).balanced_accuracy()));
}

TEST_CASE("student_quantile: of tables (95 %, two-sided)") {
    for (const auto& [freedom, t] : {std::pair(1, 12.70620),
                                     {2, 4.30265},
                                     {3, 3.18245},
                                     {4, 2.77645},
                                     {9, 2.26216},
                                     {12, 2.17881},
                                     {19, 2.09302},
                                     {120, 1.97993}}) {
        CAPTURE(freedom);
        CHECK(student_quantile(0.95, static_cast<std::size_t>(freedom)) == doctest::Approx(t).epsilon(1e-5));
    }
}

TEST_CASE("mean_interval: one method, and two on the same splits") {
    const std::vector<double> first{0.9, 0.94, 0.95, 0.97}, second{0.88, 0.93, 0.93, 0.94};
    const mean_interval alone = mean_interval::of(first, 0);
    CHECK(alone.mean == doctest::Approx(0.94));
    // 3.1824 x 0.0294392 / 2
    CHECK(alone.high == doctest::Approx(0.94 + 0.046844).epsilon(1e-4));
    CHECK(alone.low == doctest::Approx(0.94 - 0.046844).epsilon(1e-4));
    // Overlapping splits: x sqrt(1/4 + 1/3) in place of sqrt(1/4).
    CHECK(mean_interval::of(first, 1.0 / 3).high - 0.94 ==
          doctest::Approx(0.046844 * std::sqrt(7.0 / 3)).epsilon(1e-4));
    const mean_interval both = mean_interval::of_differences(first, second, 0);
    CHECK(both.mean == doctest::Approx(0.02));
    CHECK(both.probability == doctest::Approx(0.016294).epsilon(1e-3)); // t = 4.89898, 3 degrees of freedom
    CHECK(mean_interval::of_differences(first, first, 0).probability == 1);
    CHECK(std::isinf(mean_interval::of(std::vector<double>{0.5}, 0).high));
    CHECK_THROWS_AS((void)mean_interval::of_differences(first, {}, 0), std::invalid_argument);
}

TEST_CASE("accuracy_interval: of tables, also where all are right") {
    CHECK(accuracy_interval(95, 100).low == doctest::Approx(0.888250).epsilon(1e-5));
    CHECK(accuracy_interval(95, 100).high == doctest::Approx(0.978456).epsilon(1e-5));
    CHECK(accuracy_interval(20, 20).high == doctest::Approx(1));
    CHECK(accuracy_interval(20, 20).low == doctest::Approx(0.838875).epsilon(1e-5));
}
