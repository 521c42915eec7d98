#include <tactnet/eigen/memory.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

namespace {

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

} // namespace

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
