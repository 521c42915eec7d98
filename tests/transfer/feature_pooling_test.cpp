#include <tactnet/transfer/feature_pooling.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

using namespace tactnet;

TEST_CASE("feature_pooling: all, the largest and the mean of each channel") {
    constexpr shape map{2, 2, 3};
    static_assert(feature_count(feature_pooling::none, map) == 12);
    static_assert(feature_count(feature_pooling::maximum, map) == 3);
    static_assert(feature_count(feature_pooling::average, map) == 3);
    const std::array<float, 12> values{1, 2, 3, 4, -1, -2, -3, -4, 0, 0, 8, 0};
    const auto features = [&](feature_pooling pooling) {
        std::vector<float> result(feature_count(pooling, map));
        pool_features(pooling, values, map, result);
        return result;
    };
    CHECK(features(feature_pooling::none) == std::vector<float>(values.begin(), values.end()));
    CHECK(features(feature_pooling::maximum) == std::vector<float>{4, -1, 8});
    CHECK(features(feature_pooling::average) == std::vector<float>{2.5F, -2.5F, 2});
}
