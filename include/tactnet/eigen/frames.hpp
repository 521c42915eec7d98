#pragma once

#include <tactnet/eigen/memory.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

// Frames: a matrix of rows × columns, stored row by row, is a frame of shape{rows, columns}, and has the same
// memory. A frame of several channels is a matrix of (channels · rows) × columns: its planes, one below the
// other. A vector of `size()` coefficients is a frame too, such as one row of a matrix that holds a frame a
// row.
//
//     Eigen::Matrix<float, 28, 50, Eigen::RowMajor> pressure;        // or frame_matrix<float, shape{28, 50}>
//     network.infer(view_frame(pressure), logits);               // sizes compared when compiling
//     Eigen::Matrix<float, -1, -1, Eigen::RowMajor> cells(28, 50);
//     network.infer(view_frame<shape{28, 50}>(cells), logits);   // compared when called

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The matrix whose memory is a frame of that shape.
template <class T, shape Shape>
using frame_matrix =
    row_major_matrix<T, static_cast<int>(Shape.channels* Shape.rows), static_cast<int>(Shape.columns)>;

template <int Rows, int Columns, int ExpectedRows, int ExpectedColumns>
concept matrix_has_size = (Rows == ExpectedRows) && (Columns == ExpectedColumns);

namespace detail {

template <int Rows, int Columns, int ExpectedRows, int ExpectedColumns>
constexpr void check_matrix_size() {
    static_assert(matrix_has_size<Rows, Columns, ExpectedRows, ExpectedColumns>,
                  "frame: the matrix has another size than the frame; matrix_has_size shows its rows, its "
                  "columns, expected rows (of all channels), expected columns");
}

template <class M, shape Shape>
constexpr void check_frame_size() {
    constexpr int rows = static_cast<int>(Shape.channels * Shape.rows),
                  columns = static_cast<int>(Shape.columns), size = static_cast<int>(Shape.size());
    // What is known when running only is looked at then.
    constexpr auto known = [](int found, int expected) { return found == Eigen::Dynamic ? expected : found; };
    if constexpr (!(M::IsVectorAtCompileTime && known(M::SizeAtCompileTime, size) == size))
        check_matrix_size<known(M::RowsAtCompileTime, rows), known(M::ColsAtCompileTime, columns), rows,
                          columns>();
}

template <class M, shape Shape>
[[nodiscard]] bool has_frame_size(const M& matrix) noexcept {
    if constexpr (M::IsVectorAtCompileTime)
        return matrix.size() == static_cast<Eigen::Index>(Shape.size());
    else
        return matrix.rows() == static_cast<Eigen::Index>(Shape.channels * Shape.rows) &&
               matrix.cols() == static_cast<Eigen::Index>(Shape.columns);
}

/// Whether nothing about a frame is left to be looked at when called.
template <class M>
inline constexpr bool frame_is_known = M::SizeAtCompileTime != Eigen::Dynamic&& strides_are_known<M>;

template <class M, shape Shape>
[[noreturn]] void refuse_frame(const M& matrix) {
    throw std::invalid_argument(
        "frame: expected a matrix of " + std::to_string(Shape.channels * Shape.rows) + " x " +
        std::to_string(Shape.columns) + " stored row by row without gaps, found " +
        std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
        (has_frame_size<M, Shape>(matrix) ? " with gaps between its rows or coefficients" : ""));
}

template <class M>
[[nodiscard]] constexpr shape frame_shape() {
    static_assert(M::SizeAtCompileTime != Eigen::Dynamic,
                  "view_frame: the matrix's size is known when running only; name the frame's shape, as in "
                  "view_frame<shape{28, 50}>(matrix)");
    if (M::SizeAtCompileTime == Eigen::Dynamic)
        return {};
    return {static_cast<std::size_t>(M::RowsAtCompileTime), static_cast<std::size_t>(M::ColsAtCompileTime)};
}

} // namespace detail

/// A matrix as a frame of that shape, without a copy; the matrix must outlive it. For control loops: nothing
/// if a size that is known when running only is another, or if rows do not follow each other without gaps.
template <shape Shape, eigen_dense M>
[[nodiscard]] auto try_view_frame(M&& matrix) noexcept
    -> std::optional<tensor_view<detail::coefficient<M>, Shape>> {
    using type = std::remove_cvref_t<M>;
    detail::check_viewable<M>();
    detail::check_frame_size<type, Shape>();
    if constexpr (detail::is_in_memory<M>) {
        if (detail::has_frame_size<type, Shape>(matrix) && detail::lies_row_by_row(matrix))
            return tensor_view<detail::coefficient<M>, Shape>(matrix.data());
    }
    return std::nullopt;
}

/// The same; throws std::invalid_argument in place of nothing. For a matrix whose type tells all, it never
/// throws.
template <shape Shape, eigen_dense M>
[[nodiscard]] auto view_frame(M&& matrix) noexcept(detail::frame_is_known<std::remove_cvref_t<M>>)
    -> tensor_view<detail::coefficient<M>, Shape> {
    const auto view = try_view_frame<Shape>(std::forward<M>(matrix));
    if constexpr (!detail::frame_is_known<std::remove_cvref_t<M>>)
        if (!view)
            detail::refuse_frame<std::remove_cvref_t<M>, Shape>(matrix);
    return *view;
}
/// A matrix of fixed size as the frame of one channel that it is.
template <eigen_dense M>
[[nodiscard]] auto view_frame(M&& matrix) noexcept(detail::frame_is_known<std::remove_cvref_t<M>>) {
    return view_frame<detail::frame_shape<std::remove_cvref_t<M>>()>(std::forward<M>(matrix));
}

/// A copy, for what cannot be viewed: matrices stored column by column, parts of matrices, expressions.
/// Throws std::invalid_argument if a size that is known when running only is another.
template <shape Shape, eigen_dense M>
[[nodiscard]] auto copy_frame(const M& matrix) -> tensor<typename M::Scalar, Shape> {
    detail::check_frame_size<M, Shape>();
    if (!detail::has_frame_size<M, Shape>(matrix))
        throw std::invalid_argument("frame: expected a matrix of " +
                                    std::to_string(Shape.channels * Shape.rows) + " x " +
                                    std::to_string(Shape.columns) + ", found " +
                                    std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()));
    tensor<typename M::Scalar, Shape> frame;
    // A vector stays one: Eigen does not assign it to a matrix of unknown size.
    constexpr int rows = M::RowsAtCompileTime, columns = M::ColsAtCompileTime;
    using copied = row_major_matrix<typename M::Scalar, rows, columns>;
    Eigen::Map<copied> copy(frame.data(), matrix.rows(), matrix.cols());
    if constexpr (std::is_base_of_v<Eigen::ArrayBase<M>, M>)
        copy.array() = matrix;
    else
        copy = matrix;
    return frame;
}

/// A frame as a matrix of (channels · rows) × columns, without a copy; the frame must outlive it.
template <class T, shape Shape>
[[nodiscard]] auto map_frame(tensor_view<T, Shape> frame) noexcept {
    using matrix = frame_matrix<std::remove_const_t<T>, Shape>;
    return Eigen::Map<std::conditional_t<std::is_const_v<T>, const matrix, matrix>>(frame.data());
}
template <class T, shape Shape>
[[nodiscard]] auto map_frame(tensor<T, Shape>& frame) noexcept {
    return map_frame(frame.view());
}
template <class T, shape Shape>
[[nodiscard]] auto map_frame(const tensor<T, Shape>& frame) noexcept {
    return map_frame(frame.view());
}
template <class T, shape Shape>
void map_frame(tensor<T, Shape>&&) = delete; // it would be gone before its map

/// The planes of a frame or of a layer's maps, a matrix of rows × columns for each channel.
template <class T, shape Shape>
[[nodiscard]] auto map_planes(tensor_view<T, Shape> frame) noexcept {
    constexpr shape plane{Shape.rows, Shape.columns};
    return [&]<std::size_t... Channel>(std::index_sequence<Channel...>) {
        return std::array{map_frame(tensor_view<T, plane>(frame.data() + Channel * plane.size()))...};
    }
    (std::make_index_sequence<Shape.channels>());
}
template <class T, shape Shape>
[[nodiscard]] auto map_planes(tensor<T, Shape>& frame) noexcept {
    return map_planes(frame.view());
}
template <class T, shape Shape>
[[nodiscard]] auto map_planes(const tensor<T, Shape>& frame) noexcept {
    return map_planes(frame.view());
}
template <class T, shape Shape>
void map_planes(tensor<T, Shape>&&) = delete;

} // namespace TACTNET_ARCH
} // namespace tactnet
