#include <tactnet/eigen/features.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <vector>

using namespace tactnet;

TEST_CASE("features: a matrix of samples x features is viewed where it lies") {
    Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor> samples(3, 4);
    samples.setRandom();
    const auto rows = view_features(samples);
    static_assert(std::is_same_v<decltype(rows), const feature_rows<4>>);
    CHECK(rows.values().data() == samples.data());
    CHECK(rows.size() == 3);
    CHECK(rows.row(2)[1] == samples(2, 1));

    const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> any = samples;
    static_assert(std::is_same_v<decltype(view_features(any)), feature_rows<>>);
    CHECK(view_features(any).features() == 4);
    CHECK(view_features(any).values().data() == any.data());
    CHECK(view_features<4>(any).row(1).data() == &any(1, 0));
    CHECK_THROWS_WITH_AS((void)view_features<5>(any),
                         "rows of features: expected 5 features in whole rows, found 12 values in rows of 4",
                         std::invalid_argument);
    CHECK_THROWS_AS((void)view_features(any.leftCols(3)), std::invalid_argument);
    CHECK(view_features(any.topRows(2)).size() == 2);
    CHECK(view_features(samples.topRows(0)).size() == 0);
}

TEST_CASE("features: rows become a matrix in place, and rows again") {
    const std::vector<float> values{1, 2, 3, 4, 5, 6};
    const auto fixed = map_features(feature_rows<3>(values));
    static_assert(decltype(fixed)::ColsAtCompileTime == 3);
    CHECK(fixed.data() == values.data());
    CHECK(fixed.rows() == 2);
    CHECK(fixed(1, 0) == 4);
    const auto dynamic = map_features(feature_rows<>(values, 2));
    static_assert(decltype(dynamic)::ColsAtCompileTime == Eigen::Dynamic);
    CHECK(dynamic.rows() == 3);
    CHECK(dynamic.cols() == 2);
    CHECK(dynamic(1, 1) == 4);
    CHECK(map_features(feature_rows<1>(values)).rows() == 6);
    CHECK(view_features(fixed).values().data() == values.data());
    CHECK(view_features(dynamic).features() == 2);
}
