#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/text/message.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <ranges>
#include <span>
#include <string>
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

// Logits, parameters and other sequences of numbers. Where this library takes a std::span, Eigen has a
// vector, or a matrix with a row for each frame.
//
//     Eigen::Vector<float, 22> logits;
//     network.infer(frame, view_elements(logits));

template <std::size_t Found, std::size_t Expected>
concept has_elements = (Found == Expected);

namespace detail {

template <class M>
inline constexpr std::size_t matrix_elements =
    M::SizeAtCompileTime == Eigen::Dynamic ? std::dynamic_extent
                                           : static_cast<std::size_t>(M::SizeAtCompileTime);

template <std::size_t Found, std::size_t Expected>
constexpr void check_elements() {
    static_assert(has_elements<Found, Expected>,
                  "elements: the matrix has more or fewer coefficients than asked for; has_elements shows "
                  "those of the matrix and those asked for");
}

} // namespace detail

/// Views the coefficients of a vector or of a row-major matrix, which must outlive the view. Returns
/// std::nullopt unless there are `Count` of them, without gaps. For control loops.
template <std::size_t Count, eigen_dense M>
[[nodiscard]] auto try_view_elements(M&& matrix) noexcept
    -> std::optional<std::span<detail::coefficient<M>, Count>> {
    detail::check_viewable<M>();
    constexpr std::size_t known = detail::matrix_elements<std::remove_cvref_t<M>>;
    if constexpr (Count != std::dynamic_extent && known != std::dynamic_extent)
        detail::check_elements<known, Count>();
    if constexpr (detail::is_in_memory<M>) {
        const auto size = static_cast<std::size_t>(matrix.size());
        if ((Count == std::dynamic_extent || size == Count) && detail::lies_row_by_row(matrix))
            return std::span<detail::coefficient<M>, Count>(matrix.data(), size);
    }
    return std::nullopt;
}

/// As try_view_elements, but throws std::invalid_argument. It never throws if the type of the matrix
/// determines its size and strides.
template <std::size_t Count, eigen_dense M>
[[nodiscard]] auto view_elements(M&& matrix) noexcept(detail::matrix_elements<std::remove_cvref_t<M>> ==
                                                          Count &&
                                                      detail::strides_are_known<std::remove_cvref_t<M>>)
    -> std::span<detail::coefficient<M>, Count> {
    const auto view = try_view_elements<Count>(std::forward<M>(matrix));
    if constexpr (detail::matrix_elements<std::remove_cvref_t<M>> != Count ||
                  !detail::strides_are_known<std::remove_cvref_t<M>>)
        if (!view)
            detail::throw_invalid_argument(
                {"elements: expected ",
                 Count == std::dynamic_extent ? std::string("coefficients")
                                              : std::to_string(Count) + " coefficients",
                 " without gaps, found ", std::to_string(matrix.size()),
                 detail::lies_row_by_row(matrix) ? "" : " with gaps between them"});
    return *view;
}
/// As above, for as many coefficients as the matrix has; a constant if its size is one.
template <eigen_dense M>
[[nodiscard]] auto view_elements(M&& matrix) noexcept(
    noexcept(view_elements<detail::matrix_elements<std::remove_cvref_t<M>>>(std::forward<M>(matrix)))) {
    return view_elements<detail::matrix_elements<std::remove_cvref_t<M>>>(std::forward<M>(matrix));
}

/// Maps numbers in a std::span, std::array or std::vector, which must outlive the map, as a column vector.
template <std::ranges::contiguous_range R>
    requires std::ranges::borrowed_range<R>
[[nodiscard]] auto map_vector(R&& numbers) {
    const std::span all(numbers);
    using element = typename decltype(all)::element_type;
    using vector = Eigen::Matrix<std::remove_const_t<element>, detail::eigen_size<decltype(all)::extent>, 1>;
    return Eigen::Map<std::conditional_t<std::is_const_v<element>, const vector, vector>>(
        all.data(), static_cast<Eigen::Index>(all.size()));
}

/// Maps numbers as a matrix with rows of `Columns` numbers, such as the logits of a batch. Throws
/// std::invalid_argument unless they are whole rows.
template <std::size_t Columns, std::ranges::contiguous_range R>
    requires std::ranges::borrowed_range<R>
[[nodiscard]] auto map_rows(R&& numbers) {
    static_assert(Columns > 0, "map_rows: a row has at least one number");
    const std::span all(numbers);
    if (all.size() % Columns != 0)
        detail::throw_invalid_argument(
            {"rows: expected whole rows of ", Columns, " numbers, found ", all.size(), " numbers"});
    using element = typename decltype(all)::element_type;
    using matrix = row_major_matrix<std::remove_const_t<element>, Eigen::Dynamic, static_cast<int>(Columns)>;
    return Eigen::Map<std::conditional_t<std::is_const_v<element>, const matrix, matrix>>(
        all.data(), static_cast<Eigen::Index>(all.size() / Columns), static_cast<Eigen::Index>(Columns));
}

/// Maps a trained array, which must outlive the map, as a matrix with a row for each entry of the first
/// extent. The weights of a dense layer become outputs × inputs, the weights of a convolution filters ×
/// (channels · rows · columns), a bias one column. Throws std::invalid_argument unless there are as many
/// values as the extents say.
///
///     network.for_each_parameter([](const parameter& p, auto values) {
///         if (p.name == "fc.weight")
///             std::cout << map_parameter(p.extents, values).rowwise().norm();
///     });
template <class T>
[[nodiscard]] auto map_parameter(std::span<const std::size_t> extents, std::span<T> values) {
    const std::size_t rows = extents.empty() ? 1 : extents[0];
    std::size_t columns = 1;
    for (std::size_t e = 1; e < extents.size(); ++e)
        columns *= extents[e];
    if (rows * columns != values.size())
        detail::throw_invalid_argument(
            {"map_parameter: expected ", rows, " x ", columns, " values, found ", values.size()});
    using matrix = row_major_matrix<std::remove_const_t<T>, Eigen::Dynamic, Eigen::Dynamic>;
    return Eigen::Map<std::conditional_t<std::is_const_v<T>, const matrix, matrix>>(
        values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
}

}} // namespace tactnet
