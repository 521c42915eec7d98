#include <tactnet/transfer/feature_extractor.hpp>

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

TEST_CASE("feature_pooling: a number for each channel, and none more") {
    const std::vector<float> values{1, 2, 3, 4, 50, 60}; // two channels of two pixels, and what lies behind
    for (const feature_pooling pooling : {feature_pooling::maximum, feature_pooling::average}) {
        std::vector<float> result(6, -9.0F);
        pool_features(pooling, values, shape{1, 2, 2}, result);
        CHECK(result[0] > 0);
        CHECK(result[1] > 0);
        CHECK(result[2] == -9);
    }
}
