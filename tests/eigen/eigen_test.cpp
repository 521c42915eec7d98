#include <tactnet/eigen/elements.hpp>
#include <tactnet/eigen/frames.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators/dense/layer.hpp>

#include <doctest/doctest.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace {

using namespace tactnet;

TEST_CASE("elements: vectors are spans of fixed or of dynamic extent") {
    Eigen::Vector<float, 22> logits;
    const auto view = view_elements(logits);
    static_assert(std::is_same_v<decltype(view), const std::span<float, 22>>);
    static_assert(noexcept(view_elements(logits)));
    CHECK(view.data() == logits.data());
    const Eigen::RowVectorXf dynamic = Eigen::RowVectorXf::Zero(22);
    static_assert(std::is_same_v<decltype(view_elements(dynamic)), std::span<const float>>);
    CHECK(view_elements(dynamic).data() == dynamic.data());
    CHECK(view_elements(dynamic).size() == 22);
    const std::span<const float, 22> asked = view_elements<22>(dynamic);
    CHECK(asked.data() == dynamic.data());
    static_assert(noexcept(try_view_elements<22>(dynamic)));
    CHECK_FALSE(try_view_elements<21>(dynamic));
    CHECK_THROWS_WITH_AS((void)view_elements<21>(dynamic),
                         "elements: expected 21 coefficients without gaps, found 22", std::invalid_argument);
}

TEST_CASE("elements: a matrix with a row for each frame is one run of numbers") {
    Eigen::Matrix<float, Eigen::Dynamic, 5, Eigen::RowMajor> rows(3, 5);
    CHECK(view_elements(rows).data() == rows.data());
    CHECK(view_elements(rows).size() == 15);
    CHECK(view_elements<5>(rows.row(1)).data() == &rows(1, 0));
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> wide(3, 8);
    CHECK_THROWS_WITH_AS((void)view_elements(wide.leftCols(5)),
                         "elements: expected coefficients without gaps, found 15 with gaps between them",
                         std::invalid_argument);
    Eigen::Matrix<float, Eigen::Dynamic, 5, Eigen::RowMajor> none(0, 5);
    CHECK(view_elements(none).empty());
}

TEST_CASE("elements: spans, arrays and vectors become Eigen's vectors in place") {
    std::array<float, 4> logits{1, 2, 3, 4};
    auto fixed = map_vector(logits);
    static_assert(std::is_same_v<decltype(fixed), Eigen::Map<Eigen::Vector4f>>);
    fixed *= 2;
    CHECK(logits[3] == 8);
    const std::vector<double> numbers{1, 2, 3};
    const auto dynamic = map_vector(numbers);
    static_assert(std::is_same_v<decltype(dynamic), const Eigen::Map<const Eigen::VectorXd>>);
    CHECK(dynamic.data() == numbers.data());
    CHECK(dynamic.sum() == 6);
    CHECK(map_vector(std::span<float, 4>(logits)).data() == logits.data());
    // And back.
    const auto back = view_elements(map_vector(logits));
    static_assert(std::is_same_v<decltype(back), const std::span<float, 4>>);
    CHECK(back.data() == logits.data());
}

TEST_CASE("elements: rows of logits become a matrix in place") {
    std::vector<float> logits(6);
    auto rows = map_rows<3>(logits);
    static_assert(decltype(rows)::ColsAtCompileTime == 3 && decltype(rows)::IsRowMajor);
    CHECK(rows.rows() == 2);
    rows(1, 0) = 5;
    CHECK(logits[3] == 5);
    CHECK(map_rows<1>(logits).rows() == 6);
    CHECK(map_rows<3>(std::span<float>()).rows() == 0);
    CHECK_THROWS_WITH_AS((void)map_rows<4>(logits), "rows: expected whole rows of 4 numbers, found 6 numbers",
                         std::invalid_argument);
}

TEST_CASE("map_parameter: the weights of a dense layer are outputs x inputs, where they lie") {
    network<shape{2, 3}, dense<4>> net;
    int seen = 0;
    net.for_each_parameter([&](const parameter& p, auto values) {
        auto matrix = map_parameter(p.extents, values);
        CHECK(matrix.data() == values.data());
        CHECK(matrix.rows() == 4);
        CHECK(matrix.cols() == (p.name == "fc.weight" ? 6 : 1));
        matrix.row(1).setConstant(3);
        ++seen;
    });
    CHECK(seen == 2);
    const auto& constant = net;
    constant.for_each_parameter([&](const parameter& p, auto values) {
        const auto matrix = map_parameter(p.extents, values);
        CHECK(matrix.sum() == (p.name == "fc.weight" ? 18 : 3));
    });
    CHECK(net.learnable_values()[6] == 3);
    CHECK(net.learnable_values()[12] == 0);
}

TEST_CASE("map_parameter: all extents but the first lie side by side, and must fit the values") {
    std::vector<float> values(24);
    const std::vector<std::size_t> filters{2, 3, 2, 2};
    const auto matrix = map_parameter(filters, std::span(values));
    CHECK(matrix.rows() == 2);
    CHECK(matrix.cols() == 12);
    CHECK_THROWS_WITH_AS((void)map_parameter(filters, std::span(values).first(23)),
                         "map_parameter: expected 2 x 12 values, found 23", std::invalid_argument);
    CHECK(map_parameter({}, std::span(values).first(1)).size() == 1);
}

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

using row_major = Eigen::Matrix<float, 4, 6, Eigen::RowMajor>;
using column_major = Eigen::Matrix<float, 4, 6>;
using dynamic_rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using dynamic_columns = Eigen::MatrixXf;

static_assert(eigen_dense<row_major> && eigen_dense<const row_major&> && eigen_dense<Eigen::Map<row_major>>);
static_assert(eigen_dense<Eigen::Ref<const row_major>> && eigen_dense<Eigen::ArrayXXf>);
static_assert(eigen_dense<decltype(row_major() + row_major())>);
static_assert(!eigen_dense<int> && !eigen_dense<float[24]>);

static_assert(detail::is_in_memory<row_major> && !detail::is_in_memory<decltype(row_major() + row_major())>);

static_assert(detail::may_lie_row_by_row<row_major>() && detail::strides_are_known<row_major>);
static_assert(!detail::may_lie_row_by_row<column_major>() && !detail::may_lie_row_by_row<dynamic_columns>());
static_assert(detail::may_lie_row_by_row<dynamic_rows>() && !detail::strides_are_known<dynamic_rows>);
static_assert(detail::may_lie_row_by_row<Eigen::Vector4f>() &&
              detail::may_lie_row_by_row<Eigen::RowVector4f>());

// A reference may have gaps between its rows, and a part of fewer columns has; whole rows have none.
static_assert(detail::may_lie_row_by_row<Eigen::Ref<row_major>>() &&
              !detail::strides_are_known<Eigen::Ref<row_major>>);
static_assert(!detail::may_lie_row_by_row<decltype(row_major().leftCols<3>())>());
static_assert(detail::may_lie_row_by_row<decltype(row_major().topRows<2>())>());
static_assert(detail::may_lie_row_by_row<decltype(row_major().row(0))>() &&
              !detail::may_lie_row_by_row<decltype(row_major().col(0))>());
static_assert(detail::may_lie_row_by_row<decltype(column_major().col(0))>() &&
              !detail::may_lie_row_by_row<decltype(column_major().row(0))>());
static_assert(!detail::may_lie_row_by_row<Eigen::Map<row_major, 0, Eigen::InnerStride<2>>>());
static_assert(!detail::may_lie_row_by_row<Eigen::Map<row_major, 0, Eigen::OuterStride<8>>>());
static_assert(detail::may_lie_row_by_row<Eigen::Map<row_major, 0, Eigen::OuterStride<6>>>());

static_assert(detail::may_own_copy<row_major> && detail::may_own_copy<Eigen::ArrayXXf> &&
              detail::may_own_copy<Eigen::Ref<const row_major>>);
static_assert(!detail::may_own_copy<Eigen::Ref<row_major>> && !detail::may_own_copy<Eigen::Map<row_major>>);

static_assert(std::is_same_v<detail::coefficient<row_major&>, float> &&
              std::is_same_v<detail::coefficient<const row_major&>, const float> &&
              std::is_same_v<detail::coefficient<Eigen::Map<const row_major>>, const float>);

// A single column is one in memory, too.
static_assert(!row_major_matrix<float, 5, 1>::IsRowMajor && row_major_matrix<float, 5, 2>::IsRowMajor &&
              row_major_matrix<float, 1, 1>::IsRowMajor);

TEST_CASE("memory: gaps that only the strides of a matrix show are found when called") {
    row_major whole;
    CHECK(detail::lies_row_by_row(whole));
    dynamic_rows dynamic(4, 6);
    CHECK(detail::lies_row_by_row(dynamic));
    CHECK(detail::lies_row_by_row(dynamic.topRows(2)));
    CHECK(detail::lies_row_by_row(dynamic.block(1, 2, 1, 3))); // one row has no next one
    CHECK_FALSE(detail::lies_row_by_row(dynamic.leftCols(5)));

    const Eigen::Ref<row_major> same(whole);
    CHECK(detail::lies_row_by_row(same));
    const Eigen::Ref<dynamic_rows> part(dynamic.leftCols(5));
    CHECK_FALSE(detail::lies_row_by_row(part));

    using strided = Eigen::Map<Eigen::VectorXf, 0, Eigen::InnerStride<>>;
    CHECK(detail::lies_row_by_row(strided(whole.data(), 12, Eigen::InnerStride<>(1))));
    CHECK_FALSE(detail::lies_row_by_row(strided(whole.data(), 12, Eigen::InnerStride<>(2))));
    CHECK_FALSE(detail::lies_row_by_row(strided(whole.data(), 2, Eigen::InnerStride<>(2))));
    CHECK(detail::lies_row_by_row(strided(whole.data(), 1, Eigen::InnerStride<>(2))));
}

} // namespace
