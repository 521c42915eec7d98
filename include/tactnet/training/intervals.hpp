#pragma once

#include <tactnet/text/message.hpp>
#include <tactnet/training/metrics.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

// How far results may be off by chance: intervals of 95 %, and methods compared on the same splits.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The probability that Student's t of so many degrees of freedom lies within ±t (Abramowitz and Stegun,
/// 26.7.3 and 26.7.4).
[[nodiscard]] inline double student_within(double t, std::size_t freedom) {
    const double angle = std::atan(std::abs(t) / std::sqrt(static_cast<double>(freedom)));
    const double cosine = std::cos(angle), first = freedom % 2 == 1 ? cosine : 1;
    double term = first, sum = freedom > 1 ? first : 0;
    for (std::size_t k = freedom % 2 == 1 ? 3 : 2; k + 2 <= freedom; k += 2) {
        term *= cosine * cosine * static_cast<double>(k - 1) / static_cast<double>(k);
        sum += term;
    }
    const double series = std::sin(angle) * sum;
    return freedom % 2 == 1 ? 2 / std::numbers::pi * (angle + series) : series;
}
/// The t within ± of which Student's t lies with a probability below 1.
[[nodiscard]] inline double student_quantile(double probability, std::size_t freedom) {
    double low = 0, high = 1;
    while (student_within(high, freedom) < probability)
        high *= 2;
    for (int halving = 0; halving < 100; ++halving) {
        const double middle = (low + high) / 2;
        (student_within(middle, freedom) < probability ? low : high) = middle;
    }
    return high;
}

/// A mean over splits. The interval holds the mean over all splits of such data with a probability of 95 %,
/// if splits are alike.
struct mean_interval {
    double mean = 0, low = 0, high = 0; ///< infinite bounds for fewer than two splits
    double probability = 1;             ///< of a mean so far from 0 or farther by chance, if it were 0

    /// Splits of the same images have many in common, so that their results differ less than on new images.
    /// `test_per_training` widens the interval for that: the number of test images divided by that of
    /// training images (Nadeau and Bengio, 2003). 0 assumes that splits are independent.
    [[nodiscard]] static mean_interval of(std::span<const double> values, double test_per_training) {
        const auto [mean, deviation] = mean_and_deviation::of(values);
        const double infinity = std::numeric_limits<double>::infinity();
        if (values.size() < 2)
            return {mean, -infinity, infinity, 1};
        const double error =
            deviation * std::sqrt(1 / static_cast<double>(values.size()) + test_per_training);
        const double half = student_quantile(0.95, values.size() - 1) * error;
        const double chance = error > 0   ? 1 - student_within(mean / error, values.size() - 1)
                              : mean == 0 ? 1
                                          : 0;
        return {mean, mean - half, mean + half, chance};
    }
    /// The mean difference of two methods on the same splits, as first − second. Throws std::invalid_argument
    /// for unlike numbers of splits.
    [[nodiscard]] static mean_interval
    of_differences(std::span<const double> first, std::span<const double> second, double test_per_training) {
        if (first.size() != second.size())
            detail::throw_invalid_argument({"paired comparison: expected results on the same splits, found ",
                                            first.size(), " and ", second.size()});
        std::vector<double> differences;
        for (std::size_t i = 0; i < first.size(); ++i)
            differences.push_back(first[i] - second[i]);
        return of(differences, test_per_training);
    }
};

/// Where the accuracy lies with a probability of 95 %, if `right` of `images` that have nothing to do with
/// each other were recognised (Wilson, 1927). Of a single test; NaN without images.
[[nodiscard]] inline mean_interval accuracy_interval(std::size_t right, std::size_t images) {
    const double n = static_cast<double>(images), p = static_cast<double>(right) / n, z = 1.959963984540054;
    const double middle = (p + z * z / (2 * n)) / (1 + z * z / n);
    const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
    return {p, middle - half, middle + half};
}

}} // namespace tactnet
