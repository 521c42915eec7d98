#include <tactnet/decision/discriminant.hpp>
#include <tactnet/decision/fit_discriminant.hpp>
#include <tactnet/decision/fitting.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <support/error_of.hpp>
#include <support/summed.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr std::size_t size = 12, classes = 5, dimensions = 4;
using row = std::array<float, size>;

/// Classes whose means differ in the first five features, under noise that is ten times as large in the
/// others, and that two of the features share.
struct cloud {
    std::vector<float> features;
    std::vector<std::size_t> labels;

    cloud(std::size_t images, std::uint32_t seed, std::size_t used = classes) {
        std::mt19937 random(seed);
        std::normal_distribution<float> normal;
        for (std::size_t i = 0; i < images; ++i) {
            labels.push_back(i % used);
            const float shared = normal(random);
            for (std::size_t f = 0; f < size; ++f) {
                const float mean = f == labels.back() ? 6.0F : 0.0F;
                features.push_back(mean + (f < 5 ? 1.0F : 10.0F) * normal(random) + (f < 2 ? 3 * shared : 0));
            }
        }
    }
    std::span<const float, size> operator[](std::size_t image) const {
        return std::span(features).subspan(image * size).first<size>();
    }
};
std::string error_of(std::span<const float> features, std::span<const std::size_t> labels, std::size_t count,
                     double shrinkage = 0.5) {
    return support::error_of<std::invalid_argument>(
        [&] { (void)fit_discriminant<size, dimensions>(features, labels, count, shrinkage); });
}

/// The covariance within classes of what a map makes of 4000 images is the unit matrix within a tolerance.
template <std::size_t Dimensions>
void check_unit_covariance(const discriminant<size, Dimensions>& map, const cloud& training,
                           double tolerance) {
    std::array<std::array<double, Dimensions>, classes> means{};
    for (std::size_t i = 0; i < training.labels.size(); ++i)
        for (std::size_t d = 0; d < Dimensions; ++d)
            means[training.labels[i]][d] += static_cast<double>(map.project(training[i])[d]) / 800;
    std::array<std::array<double, Dimensions>, Dimensions> covariance{};
    for (std::size_t i = 0; i < training.labels.size(); ++i) {
        const auto point = map.project(training[i]);
        const auto& mean = means[training.labels[i]];
        for (std::size_t a = 0; a < Dimensions; ++a)
            for (std::size_t b = 0; b < Dimensions; ++b)
                covariance[a][b] += (static_cast<double>(point[a]) - mean[a]) *
                                    (static_cast<double>(point[b]) - mean[b]) / 4000;
    }
    for (std::size_t a = 0; a < Dimensions; ++a)
        for (std::size_t b = 0; b < Dimensions; ++b)
            CHECK(std::abs(covariance[a][b] - (a == b ? 1 : 0)) < tolerance);
}

} // namespace

TEST_CASE("fit_discriminant: the Cholesky factor and the eigensystem, put together again") {
    constexpr std::size_t n = 9;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> value(-1, 1);
    std::vector<double> root(n * n), matrix(n * n);
    for (double& one : root)
        one = value(random);
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b)
            for (std::size_t k = 0; k < n; ++k)
                matrix[a * n + b] += root[a * n + k] * root[b * n + k];
    std::vector<double> factor = matrix, x(n), b(n);
    detail::factorise(factor, n);
    for (std::size_t i = 0; i < n; ++i)
        b[i] = x[i] = value(random);
    detail::solve_lower(factor, n, x);
    detail::solve_upper(factor, n, x); // matrix · x = b
    const detail::eigensystem found = detail::diagonalise(matrix, n);
    for (std::size_t i = 0; i < n; ++i) {
        double product = 0;
        for (std::size_t k = 0; k < n; ++k)
            product += matrix[i * n + k] * x[k];
        CHECK(product == doctest::Approx(b[i]).epsilon(1e-8));
        for (std::size_t j = 0; j < n; ++j) {
            double again = 0, unit = 0;
            for (std::size_t k = 0; k < n; ++k) {
                again += found.vectors[i * n + k] * found.values[k] * found.vectors[j * n + k];
                unit += found.vectors[k * n + i] * found.vectors[k * n + j];
            }
            CHECK(std::abs(again - matrix[i * n + j]) < 1e-12);
            CHECK(std::abs(unit - (i == j ? 1 : 0)) < 1e-12);
        }
    }
}

TEST_CASE("fit_discriminant: unit covariance within classes, and classes apart that noise hides") {
    const cloud training(4000, 1), test(2000, 2);
    const auto map = fit_discriminant<size, dimensions>(training.features, training.labels, classes, 1e-6);
    class_means<dimensions, classes> means;
    for (std::size_t i = 0; i < training.labels.size(); ++i)
        REQUIRE(means.learn(training.labels[i], map->project(training[i])));
    std::size_t right = 0;
    for (std::size_t i = 0; i < test.labels.size(); ++i)
        right += means.nearest(map->project(test[i]))->index == test.labels[i];
    CHECK(right > 1960); // 98 %; by the features themselves noise of 10 hides a distance of 6
    check_unit_covariance(*map, training, 0.01);
}

TEST_CASE(
    "fit_discriminant: the mean of all images is the origin; fully shrunk, distances are those of features") {
    const cloud training(1000, 6);
    const auto map = fit_discriminant<size, dimensions>(training.features, training.labels, classes, 1);
    std::array<double, dimensions> sums{};
    std::array<std::array<double, size>, classes> means{};
    for (std::size_t i = 0; i < 1000; ++i) {
        const auto point = map->project(training[i]);
        for (std::size_t d = 0; d < dimensions; ++d)
            sums[d] += static_cast<double>(point[d]) / 1000;
        for (std::size_t f = 0; f < size; ++f)
            means[training.labels[i]][f] += static_cast<double>(training[i][f]) / 200;
    }
    for (const double sum : sums)
        CHECK(std::abs(sum) < 1e-5);
    double variance = 0; // within classes, the mean of all features
    for (std::size_t i = 0; i < 1000; ++i)
        for (std::size_t f = 0; f < size; ++f)
            variance +=
                std::pow(static_cast<double>(training[i][f]) - means[training.labels[i]][f], 2) / 1000 / size;
    for (std::size_t a = 0; a < classes; ++a)
        for (std::size_t b = 0; b < a; ++b) {
            row first, second;
            double apart = 0, projected = 0;
            for (std::size_t f = 0; f < size; ++f) {
                first[f] = static_cast<float>(means[a][f]), second[f] = static_cast<float>(means[b][f]);
                apart += (means[a][f] - means[b][f]) * (means[a][f] - means[b][f]) / variance;
            }
            const auto p = map->project(first), q = map->project(second);
            for (std::size_t d = 0; d < dimensions; ++d)
                projected += std::pow(static_cast<double>(p[d]) - static_cast<double>(q[d]), 2);
            CHECK(projected == doctest::Approx(apart).epsilon(1e-4));
        }
}

TEST_CASE("fit_discriminant: directions in which no classes lie apart are zero") {
    cloud training(600, 3, 2); // two classes, and three copies of them
    for (std::size_t i = 0; i < training.labels.size(); ++i)
        training.labels[i] = i % 5 < 3 ? 0 : 1;
    std::vector<float> features;
    for (std::size_t i = 0; i < training.labels.size(); ++i)
        for (std::size_t f = 0; f < size; ++f)
            features.push_back(f == 0 ? static_cast<float>(training.labels[i]) + 0.1F * training[i][f]
                                      : 0.0F);
    const auto map = fit_discriminant<size, 1>(features, training.labels, 2);
    CHECK(map->directions[0] != 0);
    std::vector<std::size_t> labels = training.labels;
    for (std::size_t i = 0; i < labels.size(); ++i)
        labels[i] = labels[i] * 3 + i % 3; // 6 classes on a line
    const auto line = fit_discriminant<size, 5>(features, labels, 6, 0.5);
    for (std::size_t f = 1; f < size; ++f)
        for (std::size_t d = 0; d < 5; ++d)
            CHECK(std::abs(line->directions[f * 5 + d]) < 1e-6);
}

TEST_CASE("fit_discriminant: refuses what it cannot fit") {
    const cloud training(50, 4);
    CHECK(error_of(std::span(training.features).first(599), training.labels, classes) ==
          "fit_discriminant: expected a row of 12 features for each of 50 labels, found 599 features");
    CHECK(error_of(training.features, training.labels, 4) ==
          "fit_discriminant: expected more than 4 classes, found 4");
    CHECK(error_of(training.features, training.labels, 6) ==
          "fit_discriminant: expected an image of each class, found none of class 5");
    for (const double shrinkage : {0.0, 1.5, std::numeric_limits<double>::quiet_NaN()})
        CHECK(error_of(training.features, training.labels, classes, shrinkage)
                  .starts_with("fit_discriminant: expected a shrinkage above 0 and at most 1, found"));
    std::vector<std::size_t> labels = training.labels;
    labels[7] = 5;
    CHECK(error_of(training.features, labels, classes) ==
          "fit_discriminant: expected labels below 5, found 5");
    std::vector<float> features = training.features;
    features[3 * size] = std::numeric_limits<float>::infinity();
    CHECK(error_of(features, training.labels, classes) ==
          "fit_discriminant: expected finite features, found others for image 3");
    CHECK(error_of(std::vector<float>(50 * size, 1.0F), training.labels, classes) ==
          "fit_discriminant: expected features that vary within classes, found none that do");
}

TEST_CASE("class_means: learns and forgets a class without changing another, and without heap") {
    using means_type = class_means<2, 3>;
    using point = means_type::point;
    means_type means;
    const std::size_t before = support::allocations();
    CHECK_FALSE(means.nearest(point{0, 0}).has_value());
    CHECK(means.learn(0, point{0, 0}));
    CHECK(means.learn(0, point{2, 0}));
    CHECK(means.learn(2, point{10, 0}));
    CHECK(means.touches(0) == 2);
    CHECK(means.touches(1) == 0);
    CHECK(means.nearest(point{1, 3})->index == 0);
    CHECK(means.nearest(point{1, 3})->squared_distance == 9);
    CHECK(means.nearest(point{5.5F, 0})->index == 0); // equally near
    CHECK(means.nearest(point{6, 0})->index == 2);
    CHECK(means.learn(1, point{6, 1}));
    CHECK(means.nearest(point{6, 0})->index == 1);
    CHECK(means.nearest(point{1, 3})->squared_distance == 9);
    means.forget(1);
    means.forget(7);
    CHECK(means.nearest(point{6, 0})->index == 2);
    CHECK_FALSE(means.learn(3, point{0, 0}));
    CHECK(means.touches(3) == 0);
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        CHECK_FALSE(means.learn(1, point{0, bad}));
        CHECK_FALSE(means.nearest(point{bad, 0}).has_value());
    }
    CHECK(means.touches(1) == 0);
    CHECK(support::allocations() == before);
}

TEST_CASE("fit_largest_distance: keeps the share of false alarms") {
    std::mt19937 random(5);
    std::exponential_distribution<double> distance;
    for (const double share : {0.5, 0.05, 0.01}) {
        std::size_t alarms = 0;
        for (int draw = 0; draw < 300; ++draw) {
            std::vector<double> held_out(199);
            for (double& one : held_out)
                one = distance(random);
            const double largest = fit_largest_distance(held_out, share);
            for (int i = 0; i < 200; ++i)
                alarms += distance(random) > largest;
        }
        // 60 000 touches, and 300 draws with a deviation of √(share (1 − share) ÷ 201) each.
        const double deviation = std::sqrt(share * (1 - share) * (1 / 60'000.0 + 1 / (201.0 * 300)));
        CHECK(static_cast<double>(alarms) / 60'000 <= share + 4 * deviation);
        CHECK(static_cast<double>(alarms) / 60'000 >= share - 1 / 200.0 - 4 * deviation);
    }
    CHECK(std::isinf(fit_largest_distance(std::vector<double>(98, 1.0), 0.01)));
    CHECK(fit_largest_distance(std::vector<double>(99, 1.0), 0.01) == 1);
    CHECK_THROWS_AS((void)fit_largest_distance({}, 0), std::invalid_argument);
    CHECK_THROWS_AS((void)fit_largest_distance(std::vector<double>{std::nan("")}, 0.1),
                    std::invalid_argument);
}

TEST_CASE("fit_discriminant: no map of numbers that are not finite") {
    const cloud training(200, 8);
    const auto scaled = [&](double by) {
        std::vector<float> features;
        for (const float feature : training.features)
            features.push_back(static_cast<float>(static_cast<double>(feature) * by));
        return features;
    };
    std::vector<float> flat = training.features; // but for one feature of one image
    for (std::size_t i = 0; i < flat.size(); ++i)
        flat[i] = static_cast<float>(training.labels[i / size] == i % size);
    flat[0] += 1;
    const std::vector<std::pair<std::vector<float>, double>> cases{
        {scaled(1e-42), 0.5}, {flat, 1e-300}, {flat, 5e-324}};
    for (const auto& [features, shrinkage] : cases) {
        CAPTURE(shrinkage);
        CHECK(error_of(features, training.labels, classes, shrinkage)
                  .starts_with("fit_discriminant: expected features and a shrinkage that give a finite map"));
    }
    CHECK(error_of(scaled(1e-20), training.labels, classes) == "no error");
    CHECK(error_of(scaled(1e36), training.labels, classes) == "no error");
}

TEST_CASE("class_means: what was saved is known after a restart, and nothing else is taken") {
    using means = class_means<3, 4>;
    means before, after;
    REQUIRE(before.learn(0, {1, 2, 3}));
    REQUIRE(before.learn(0, {2, 2, 3.5f}));
    REQUIRE(before.learn(2, {-7, 0.1f, 1e30f}));
    const auto state = before.save();
    CHECK(after.restore(state) == restore_status::ok);
    CHECK(after.save() == state);
    CHECK(after.touches(0) == 2);
    CHECK(after.touches(1) == 0);
    CHECK(after.touches(2) == 1);
    const auto found = after.nearest({1, 2, 3});
    REQUIRE(found.has_value());
    CHECK(found->index == 0);
    CHECK(found->squared_distance == before.nearest({1, 2, 3})->squared_distance);
    for (std::size_t byte = 0; byte < state.size(); ++byte) {
        auto damaged = state;
        damaged[byte] ^= std::byte{128};
        CHECK(after.restore(damaged) != restore_status::ok);
    }
    CHECK(after.restore(class_means<4, 3>().save()) == restore_status::other_size);
    CHECK(after.save() == state);

    // Numbers of touches, means and sums of squares that no touches have, under a right checksum.
    constexpr std::size_t first_mean = 16 + 4 * 4, first_square = first_mean + 3 * 4 * 8;
    const auto wrong = [&](std::size_t place, auto number) {
        auto bytes = state;
        std::memcpy(bytes.data() + place, &number, sizeof(number));
        return support::summed(bytes);
    };
    for (const double mean : {double(NAN), double(INFINITY), 1e39, -1e39})
        CHECK(after.restore(wrong(first_mean, mean)) == restore_status::damaged);
    for (const double squares : {double(NAN), double(INFINITY), -1.0, 1e-310, 1e79})
        CHECK(after.restore(wrong(first_square, squares)) == restore_status::damaged);
    CHECK(after.restore(wrong(first_mean + 8, 1.0)) == restore_status::damaged);       // without touches
    CHECK(after.restore(wrong(first_square + 2 * 8, 1.0)) == restore_status::damaged); // of one touch
    CHECK(after.restore(wrong(first_square, 1e77)) == restore_status::ok); // two touches at the ends of float
    CHECK(after.restore(state) == restore_status::ok);
    CHECK(after.save() == state);

    // As many touches as there can be: one more is not learnt, and nothing is divided by zero.
    REQUIRE(after.restore(wrong(16, std::uint32_t{0xFFFFFFFE})) == restore_status::ok);
    CHECK(after.learn(0, {1, 2, 3}));
    CHECK(!after.learn(0, {1, 2, 3}));
    CHECK(std::isfinite(after.nearest({1, 2, 3})->relative_distance));
    CHECK(means().restore(after.save()) == restore_status::ok);
}

TEST_CASE("class_means: more classes than a stack has room for are saved, restored and compared") {
    using means = class_means<2, 250'000>;
    const auto before = std::make_unique<means>(), after = std::make_unique<means>();
    REQUIRE(before->learn(1, {1, 2}));
    REQUIRE(before->learn(249'999, {-3, 2}));
    std::vector<std::byte> state(means::state_bytes);
    before->save(std::span(state).first<means::state_bytes>());
    const std::size_t allocated = support::allocations();
    CHECK(after->restore(state) == restore_status::ok);
    CHECK(after->nearest({-2, 1})->index == 249'999);
    CHECK(support::allocations() == allocated);
}

TEST_CASE("discriminant: what was saved is read by another program, and nothing else is taken") {
    using map = discriminant<3, 2>;
    const map before{{1, -2, 3, 0.5f, 1e30f, 0}, {7, -1e-40f}};
    std::array<std::byte, map::state_bytes> state;
    before.save(state);
    map after;
    CHECK(after.restore(state) == restore_status::ok);
    CHECK(after.directions == before.directions);
    CHECK(after.offset == before.offset);
    for (std::size_t byte = 0; byte < state.size(); ++byte) {
        auto damaged = state;
        damaged[byte] ^= std::byte{128};
        CHECK(after.restore(damaged) != restore_status::ok);
    }
    CHECK(discriminant<2, 3>().restore(state) == restore_status::other_size);
    for (const std::size_t place : {16UL, 16UL + 7 * 4}) { // the first number and the last one
        auto wrong = state;
        std::fill_n(wrong.begin() + static_cast<std::ptrdiff_t>(place), 4, std::byte{0xFF});
        CHECK(after.restore(support::summed(wrong)) == restore_status::damaged);
    }
    CHECK(after.directions == before.directions);
    CHECK(after.offset == before.offset);
}
