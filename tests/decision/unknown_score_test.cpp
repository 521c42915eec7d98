#include <tactnet/decision/exponentials.hpp>
#include <tactnet/decision/unknown_score.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <support/allocations.hpp>
#include <vector>

using namespace tactnet;

namespace {

using map_type = discriminant<3, 2>;
using means_type = class_means<2, 4>;
using distance = distance_score<3, 2, 4>;

static_assert(unknown_score<softmax_score> && unknown_score<energy_score> && unknown_score<direction_score> &&
              unknown_score<distance>);
static_assert(!unknown_score<map_type>);

} // namespace

TEST_CASE("sum_of_exponentials: within its bound of a sum in double, for any number of values") {
    std::mt19937 random(4);
    for (const std::size_t count : {1U, 3U, 22U, 63U, 64U, 65U, 200U})
        for (const double scale : {0.05, 1.0, 20.0}) {
            std::normal_distribution<float> normal(-300, 9);
            std::vector<float> values(count);
            for (float& value : values)
                value = normal(random);
            const detail::value_range<float> range{std::span<const float>(values)};
            CHECK(range.finite);
            double expected = 0;
            for (const float value : values)
                expected +=
                    std::exp((static_cast<double>(value) - static_cast<double>(range.largest)) * scale);
            const double found =
                detail::sum_of_exponentials(std::span<const float>(values), range.largest, scale);
            // An exponent below 2⁷ is rounded to 2⁻¹⁸; its power, and what is left out, are smaller errors.
            CHECK(std::abs(found - expected) <= 0x1p-17 * (expected - 1) + 1e-12);
        }
    CHECK_FALSE(detail::value_range<float>(std::array{1.0F, std::nanf("")}).finite);
    CHECK_FALSE(detail::value_range<float>(std::array{-std::numeric_limits<float>::infinity()}).finite);
}

TEST_CASE("unknown_score: by hand") {
    const std::array logits{1.0F, 3.0F, 2.0F}, features{3.0F, 0.0F, 4.0F};
    const double sum = std::exp(1.0) + std::exp(3.0) + std::exp(2.0);
    CHECK(softmax_score{}(logits, features) == doctest::Approx(std::log(sum) - 3));
    CHECK(energy_score{}(logits, features) == doctest::Approx(-std::log(sum)));
    CHECK(direction_score{}(logits, features) == doctest::Approx(-3.0 / 5));

    map_type map;
    map.directions = {1, 0, 0, 1, 0, 0}; // the first two features
    means_type means;
    CHECK(std::isinf(distance(map, means)(logits, features))); // nothing has been learnt
    // Class 0 spreads by 1, class 1 by 9: 5 on average, which counts as eight touches.
    for (const float x : {-1.0F, 1.0F})
        CHECK(means.learn(0, {x, 0}));
    CHECK(distance(map, means)(logits, features) == doctest::Approx(9));
    for (const float x : {47.0F, 53.0F})
        CHECK(means.learn(1, {x, 0}));
    CHECK(distance(map, means)(logits, features) == doctest::Approx(9 / ((2 * 1 + 8 * 5) / 10.0)));
    CHECK(distance(map, means)(logits, std::array{50.0F, 3.0F, 0.0F}) ==
          doctest::Approx(9 / ((2 * 9 + 8 * 5) / 10.0)));

    const product_score both{distance(map, means), softmax_score{}};
    static_assert(unknown_score<decltype(both)>);
    CHECK(both(logits, features) ==
          doctest::Approx(distance(map, means)(logits, features) * softmax_score{}(logits, features)));

    const unknown_detector<distance> detector{distance(map, means), 2.0};
    CHECK(detector.is_unknown(logits, features));
    CHECK_FALSE(detector.is_unknown(logits, std::array{1.0F, 0.0F, 0.0F}));
}

TEST_CASE("unknown_score: what is not finite is of no known object, and there is no heap") {
    map_type map;
    map.directions = {1, 0, 0, 1, 0, 0};
    means_type means;
    CHECK(means.learn(0, {0, 0}));
    const std::array good{1.0F, 2.0F}, certain{200.0F, 0.0F};
    const std::array sound{1.0F, 2.0F, 3.0F}, none{0.0F, 0.0F, 0.0F};
    const std::size_t before = support::allocations();
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
        const std::array logits{1.0F, bad};
        const std::array features{bad, 0.0F, 0.0F};
        CHECK(softmax_score{}(logits, sound) == std::numeric_limits<double>::infinity());
        CHECK(energy_score{}(logits, sound) == std::numeric_limits<double>::infinity());
        CHECK(direction_score{}(logits, sound) == std::numeric_limits<double>::infinity());
        CHECK(distance(map, means)(good, features) == std::numeric_limits<double>::infinity());
        const product_score both{distance(map, means), distance(map, means)};
        CHECK(both(good, features) == std::numeric_limits<double>::infinity());
        const product_score with_zero{softmax_score{}, distance(map, means)};
        CHECK(softmax_score{}(certain, features) == 0);
        CHECK(with_zero(certain, features) == std::numeric_limits<double>::infinity());
        CHECK(unknown_detector<softmax_score>{{}, 1e300}.is_unknown(logits, sound));
    }
    CHECK(direction_score{}(good, none) == std::numeric_limits<double>::infinity());
    CHECK(support::allocations() == before);
}

TEST_CASE("class_means: the spread of a class, learnt touch by touch") {
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    constexpr std::size_t touches = 40;
    means_type means;
    CHECK(means.spread(0) == 1);
    std::vector<means_type::point> points(touches);
    std::array<double, 2> mean{};
    for (auto& point : points) {
        point = {100 + normal(random), 3 * normal(random)};
        CHECK(means.learn(1, point));
        for (std::size_t d = 0; d < 2; ++d)
            mean[d] += static_cast<double>(point[d]) / touches;
    }
    double squares = 0;
    for (const auto& point : points)
        for (std::size_t d = 0; d < 2; ++d)
            squares += (static_cast<double>(point[d]) - mean[d]) * (static_cast<double>(point[d]) - mean[d]);
    CHECK(means.spread(1) == doctest::Approx(squares / touches).epsilon(1e-9)); // the only class
    CHECK(means.learn(3, {0, 0}));
    CHECK(means.spread(3) == doctest::Approx(squares / touches * 8 / 9)); // of one touch: the average
    means_type after;
    CHECK(after.restore(means.save()) == restore_status::ok);
    CHECK(after.spread(1) == means.spread(1));
    CHECK(after.spread(3) == means.spread(3));
    means.forget(1);
    CHECK(means.spread(1) == 1);
    CHECK(means.spread(9) == 1);
}
