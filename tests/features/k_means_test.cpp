#include <tactnet/features/k_means.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;

namespace {

/// Squared distances of five numbers and their sum, in single precision and in another order.
constexpr std::size_t values = 5;
const double roundings = support::accumulated(support::unit_roundoff<float>, values + 3);

std::vector<float> random_points(std::size_t count, std::size_t width, std::uint32_t number) {
    random_stream random(3, random_purposes::order, number);
    std::vector<float> points(count * width);
    for (float& v : points)
        v = static_cast<float>(random.uniform(-1, 1));
    return points;
}

double squared(std::span<const float> points, std::size_t i, std::span<const float> centres, std::size_t c) {
    double sum = 0;
    for (std::size_t v = 0; v < values; ++v) {
        const double d =
            static_cast<double>(points[i * values + v]) - static_cast<double>(centres[c * values + v]);
        sum += d * d;
    }
    return sum;
}

/// What k-means says of its own result: nearest centres, and the objective.
void check_consistent(std::span<const float> points, const k_means_result& found) {
    const std::size_t count = points.size() / values, centres = found.centres.size() / values;
    REQUIRE(found.nearest.size() == count);
    double objective = 0;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i) {
        REQUIRE(found.nearest[i] < centres);
        double least = std::numeric_limits<double>::infinity(), largest = 0;
        for (std::size_t c = 0; c < centres; ++c) {
            least = std::min(least, squared(points, i, found.centres, c));
            double norms = 0; // of the products that the search compares
            for (std::size_t v = 0; v < values; ++v)
                norms += std::abs(static_cast<double>(found.centres[c * values + v])) *
                         (std::abs(static_cast<double>(points[i * values + v])) +
                          std::abs(static_cast<double>(found.centres[c * values + v])) / 2);
            largest = std::max(largest, norms);
        }
        const double own = squared(points, i, found.centres, found.nearest[i]);
        wrong +=
            !(own <= least + 4 * roundings * largest); // ‖x − c‖² is twice what is compared, for two centres
        objective += own;
    }
    CHECK(wrong == 0);
    CHECK(std::abs(found.objective - objective) <= roundings * objective);
}

/// Lloyd's iterations in double, one by one. Gives up where a cluster is empty.
std::vector<double> iterate_plainly(std::span<const float> points, std::span<const float> start,
                                    std::size_t iterations) {
    std::vector<double> centres(start.begin(), start.end());
    const std::size_t k = centres.size() / values;
    for (std::size_t it = 0; it < iterations; ++it) {
        std::vector<double> sums(centres.size()), counts(k);
        for (std::size_t i = 0; i < points.size() / values; ++i) {
            std::size_t best = 0;
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t c = 0; c < k; ++c) {
                double distance = 0;
                for (std::size_t v = 0; v < values; ++v)
                    distance +=
                        std::pow(static_cast<double>(points[i * values + v]) - centres[c * values + v], 2);
                if (distance < least)
                    least = distance, best = c;
            }
            ++counts[best];
            for (std::size_t v = 0; v < values; ++v)
                sums[best * values + v] += static_cast<double>(points[i * values + v]);
        }
        for (std::size_t c = 0; c < k; ++c) {
            REQUIRE(counts[c] > 0);
            for (std::size_t v = 0; v < values; ++v)
                centres[c * values + v] = sums[c * values + v] / counts[c];
        }
    }
    return centres;
}

std::set<std::vector<float>> rows_of(std::span<const float> rows, std::size_t width) {
    std::set<std::vector<float>> set;
    for (std::size_t r = 0; r < rows.size() / width; ++r)
        set.emplace(rows.begin() + static_cast<std::ptrdiff_t>(r * width),
                    rows.begin() + static_cast<std::ptrdiff_t>((r + 1) * width));
    return set;
}

} // namespace

TEST_CASE("k_means_from: every iteration against plain loops in double") {
    thread_pool one(1);
    const auto points = random_points(300, values, 1);
    const std::span<const float> start = std::span(points).first(7 * values);
    for (const std::size_t iterations : {0u, 1u, 2u, 5u, 30u}) {
        const k_means_result found =
            k_means_from<values>(points, start, {.max_iterations = iterations, .least_gain = -1}, one);
        CHECK(found.iterations == iterations);
        CHECK(!found.converged);
        check_consistent(points, found);
        const auto expected = iterate_plainly(points, start, iterations);
        REQUIRE(found.centres.size() == expected.size());
        for (std::size_t v = 0; v < expected.size(); ++v) // means of numbers below 1, summed in double
            CHECK(std::abs(static_cast<double>(found.centres[v]) - expected[v]) <=
                  support::unit_roundoff<float>);
    }
}

TEST_CASE("k_means: the objective never rises, and the end is reported") {
    thread_pool one(1);
    const auto points = random_points(2500, values, 2);
    const auto seeds = k_means_seeds<values>(points, {.centres = 40}, one);
    double last = std::numeric_limits<double>::infinity();
    for (std::size_t iterations = 0; iterations < 20; ++iterations) {
        const k_means_result found =
            k_means_from<values>(points, seeds, {.max_iterations = iterations, .least_gain = -1}, one);
        CHECK(found.objective <= last * (1 + roundings));
        last = found.objective;
    }
    const k_means_result whole =
        k_means<values>(points, {.centres = 40, .max_iterations = 1000, .least_gain = 0}, one);
    CHECK(whole.converged);
    CHECK(whole.iterations < 1000);
    CHECK(whole.objective <= last);
    check_consistent(points, whole);
}

TEST_CASE("k_means: the same bits on any number of threads") {
    thread_pool one(1), three(3), five(5);
    const auto points = random_points(5000, values, 3);
    const k_means_settings settings{.centres = 60, .max_iterations = 12};
    const k_means_result expected = k_means<values>(points, settings, one);
    for (thread_pool* threads : {&three, &five}) {
        const k_means_result found = k_means<values>(points, settings, *threads);
        CHECK(found.centres == expected.centres);
        CHECK(found.nearest == expected.nearest);
        CHECK(found.objective == expected.objective);
        CHECK(found.iterations == expected.iterations);
    }
    auto other = settings;
    other.seed = 2;
    CHECK(k_means<values>(points, other, one).centres != expected.centres);
}

TEST_CASE("k_means_seeds: points, all different, one in each of clusters far apart") {
    thread_pool two(2);
    auto points = random_points(3000, values, 4);
    for (std::size_t i = 0; i < 3000; ++i)
        points[i * values + i % values] += 1e6f * static_cast<float>(1 + i % 10); // ten clusters
    const auto all = rows_of(points, values);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto seeds = k_means_seeds<values>(points, {.centres = 10, .seed = seed}, two);
        std::set<std::vector<float>> clusters_hit;
        for (const std::vector<float>& row : rows_of(seeds, values)) {
            CHECK(all.contains(row));
            std::vector<float> rounded;
            for (const float v : row)
                rounded.push_back(std::round(v / 1e6f));
            clusters_hit.insert(rounded);
        }
        CHECK(clusters_hit.size() == 10); // chance of a miss: about 1e-11
    }
}

TEST_CASE("k_means_seeds: drawn in proportion to squared distances") {
    thread_pool one(1);
    // From 0 the others are drawn 1 : 9; from 1, 1 : 4; from 3, 9 : 4.
    const std::vector<float> points{0, 1, 3};
    std::array<std::array<double, 3>, 3> counts{};
    constexpr std::size_t draws = 6000;
    for (std::uint64_t seed = 0; seed < draws; ++seed) {
        const auto seeds = k_means_seeds<1>(points, {.centres = 2, .seed = seed}, one);
        const auto index = [](float v) { return static_cast<std::size_t>(v == 3 ? 2 : v); };
        ++counts[index(seeds[0])][index(seeds[1])];
    }
    const std::array<std::array<double, 3>, 3> shares{
        {{0, 0.1, 0.9}, {0.2, 0, 0.8}, {9.0 / 13, 4.0 / 13, 0}}};
    for (std::size_t first = 0; first < 3; ++first)
        for (std::size_t second = 0; second < 3; ++second) {
            const double share = shares[first][second] / 3, n = static_cast<double>(draws);
            // Five standard deviations of a binomial count.
            CHECK(std::abs(counts[first][second] - n * share) <= 5 * std::sqrt(n * share * (1 - share)));
        }
}

TEST_CASE("k_means_from: centres without points take those farthest from their own") {
    thread_pool one(1);
    const auto points = random_points(50, values, 5);
    // One centre four times over: the last three have no points at first.
    std::vector<float> start;
    for (int copy = 0; copy < 4; ++copy)
        start.insert(start.end(), points.begin(), points.begin() + values);
    const k_means_result before = k_means_from<values>(points, start, {.max_iterations = 0}, one);
    const k_means_result after =
        k_means_from<values>(points, start, {.max_iterations = 1, .least_gain = -1}, one);
    CHECK(after.objective < before.objective);
    CHECK(rows_of(after.centres, values).size() == 4);
    std::vector<double> distances(50);
    for (std::size_t i = 0; i < 50; ++i)
        distances[i] = squared(points, i, start, 0);
    for (std::size_t c = 1; c < 4; ++c) {
        const auto i = static_cast<std::size_t>(std::max_element(distances.begin(), distances.end()) -
                                                distances.begin());
        distances[i] = 0;
        CHECK(std::equal(points.begin() + static_cast<std::ptrdiff_t>(i * values),
                         points.begin() + static_cast<std::ptrdiff_t>((i + 1) * values),
                         after.centres.begin() + static_cast<std::ptrdiff_t>(c * values)));
    }
}

TEST_CASE("k_means: fewer different points than centres") {
    thread_pool one(1);
    std::vector<float> points;
    for (int i = 0; i < 30; ++i)
        for (std::size_t v = 0; v < values; ++v)
            points.push_back(static_cast<float>(i % 3) * 0.1f);
    const k_means_result found = k_means<values>(points, {.centres = 8}, one);
    CHECK(rows_of(found.centres, values) == rows_of(points, values));
    CHECK(found.centres.size() == 3 * values);
    CHECK(found.objective == 0);
    CHECK(found.converged);
    const k_means_result single = k_means<values>(std::span(points).first(values), {.centres = 8}, one);
    CHECK(single.centres.size() == values);
    CHECK(single.nearest == std::vector<std::uint32_t>{0});
}

TEST_CASE("k_means: rejected arguments and their messages") {
    thread_pool one(1);
    auto points = random_points(4, values, 6);
    const auto run = [&](std::span<const float> from, std::size_t centres) {
        static_cast<void>(k_means<values>(from, {.centres = centres}, one));
    };
    CHECK_THROWS_WITH(run({}, 2), "k_means: expected points of 5 numbers each, found 0 numbers");
    CHECK_THROWS_WITH(run(std::span(points).first(7), 2),
                      "k_means: expected points of 5 numbers each, found 7 numbers");
    CHECK_THROWS_WITH(run(points, 0), "k_means: expected at least one centre, found 0");
    points[2 * values + 3] = std::numeric_limits<float>::quiet_NaN();
    CHECK_THROWS_WITH(run(points, 2), "k_means: expected finite numbers of at most 1e17, found "
                                      "nan as number 3 of point 2 (counted from 0)");
    points[2 * values + 3] = 1e18f;
    CHECK_THROWS_AS(run(points, 2), std::invalid_argument);
    points[2 * values + 3] = 1e17f;
    CHECK(k_means<values>(points, {.centres = 2}, one).nearest[2] !=
          k_means<values>(points, {.centres = 2}, one).nearest[0]);
}

TEST_CASE("k_means: points far from zero have the nearest centre all the same") {
    thread_pool one(1);
    auto points = random_points(300, values, 9);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = 3e4f + (i / values % 3 == 0 ? 4.0f : i / values % 3 == 1 ? -4.0f : 0.0f) + points[i] / 4;
    const k_means_result found = k_means<values>(points, {.centres = 3}, one);
    for (std::size_t i = 3; i < 300; ++i)
        REQUIRE(found.nearest[i] == found.nearest[i % 3]);
    CHECK(found.nearest[0] != found.nearest[1]);
    CHECK(found.nearest[1] != found.nearest[2]);
}
