#include <tactnet/transfer/map_features.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

using namespace tactnet;

TEST_CASE("map features: all, the largest and the mean of each channel") {
    constexpr shape map{2, 2, 3};
    static_assert(feature_count(map_features::all, map) == 12);
    static_assert(feature_count(map_features::maximum, map) == 3);
    static_assert(feature_count(map_features::average, map) == 3);
    const std::array<float, 12> values{1, 2, 3, 4, -1, -2, -3, -4, 0, 0, 8, 0};
    const auto features = [&](map_features kind) {
        std::vector<float> result(feature_count(kind, map));
        to_features(kind, values, map, result);
        return result;
    };
    CHECK(features(map_features::all) == std::vector<float>(values.begin(), values.end()));
    CHECK(features(map_features::maximum) == std::vector<float>{4, -1, 8});
    CHECK(features(map_features::average) == std::vector<float>{2.5F, -2.5F, 2});
}
