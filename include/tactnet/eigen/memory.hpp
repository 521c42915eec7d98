#pragma once

#include <tactnet/detail/config.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <type_traits>
#include <utility>

// The storage order and strides of a matrix. Frames, feature rows and weights are row-major without gaps;
// Eigen's matrices are column-major by default, and their blocks have gaps. Strides that the type determines
// are checked when compiling, the others at run time.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A row-major Eigen matrix of Rows × Columns. Either may be Eigen::Dynamic.
template <class T, int Rows, int Columns>
using row_major_matrix =
    // Eigen requires a single column to be column-major, which is the same memory.
    Eigen::Matrix<T, Rows, Columns, Columns == 1 && Rows != 1 ? Eigen::ColMajor : Eigen::RowMajor>;

/// Anything of Eigen with coefficients: a matrix, an array, a map, a block, an expression.
template <class M>
concept eigen_dense = requires(const std::remove_reference_t<M>& matrix) {
    []<class Derived>(const Eigen::DenseBase<Derived>&) {}(matrix);
};

namespace detail {

template <class M>
inline constexpr bool may_own_copy = std::is_base_of_v<Eigen::PlainObjectBase<M>, M>;
template <class M, int Options, class Stride>
inline constexpr bool may_own_copy<Eigen::Ref<const M, Options, Stride>> = true;

/// Whether coefficients have addresses. An expression such as a + b has none.
template <class M>
inline constexpr bool is_in_memory = (std::remove_cvref_t<M>::Flags & Eigen::DirectAccessBit) != 0;

/// Whether the type allows row-major coefficients without gaps.
template <class M>
[[nodiscard]] constexpr bool may_lie_row_by_row() {
    using matrix = std::remove_cvref_t<M>;
    constexpr int inner = matrix::InnerStrideAtCompileTime, outer = matrix::OuterStrideAtCompileTime;
    if (inner != 1 && inner != Eigen::Dynamic)
        return false;
    if (matrix::IsVectorAtCompileTime)
        return true;
    return matrix::IsRowMajor && (outer == Eigen::Dynamic || matrix::ColsAtCompileTime == Eigen::Dynamic ||
                                  outer == matrix::ColsAtCompileTime);
}

/// Whether coefficients of such a type are row-major without gaps.
template <class M>
[[nodiscard]] bool lies_row_by_row(const M& matrix) noexcept {
    if (matrix.size() <= 1)
        return true;
    if (matrix.innerStride() != 1)
        return false;
    return M::IsVectorAtCompileTime || matrix.rows() == 1 || matrix.outerStride() == matrix.cols();
}

/// Whether the type determines the result of lies_row_by_row().
template <class M>
inline constexpr bool strides_are_known =
    M::InnerStrideAtCompileTime != Eigen::Dynamic &&
    (M::IsVectorAtCompileTime ||
     (M::OuterStrideAtCompileTime != Eigen::Dynamic && M::ColsAtCompileTime != Eigen::Dynamic));

/// The requirements of every view on the type of a matrix.
template <class M>
constexpr void check_viewable() {
    static_assert(is_in_memory<M>, "a view of a matrix: an expression has no memory to be viewed; evaluate "
                                   "it into a matrix, or use copy_frame");
    static_assert(
        !is_in_memory<M> || may_lie_row_by_row<M>(),
        "a view of a matrix: its coefficients must lie row by row without gaps, and this one's lie column "
        "by column (Eigen's default) or with gaps; declare it Eigen::RowMajor, or use copy_frame");
    static_assert(std::is_lvalue_reference_v<M> || !may_own_copy<std::remove_cvref_t<M>>,
                  "a view of a matrix: a temporary matrix would be gone before its view; give it a name");
}

template <class M>
struct coefficient_of {
    using type = const typename std::remove_cvref_t<M>::Scalar; // of an expression
};
template <class M>
    requires is_in_memory<M>
struct coefficient_of<M> {
    using type = std::remove_pointer_t<decltype(std::declval<std::remove_reference_t<M>&>().data())>;
};
/// The type of the coefficients of a matrix; const if they are read-only.
template <class M>
using coefficient = typename coefficient_of<M>::type;

/// A number of coefficients as Eigen expresses it.
template <std::size_t Count>
inline constexpr int eigen_size =
    Count == static_cast<std::size_t>(-1) ? Eigen::Dynamic : static_cast<int>(Count);

} // namespace detail

}} // namespace tactnet
