#pragma once

#include <tactnet/eigen/elements.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/text/message.hpp>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

// Feature rows for support vector machines: a row-major float matrix of samples × features.

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Found, std::size_t Expected>
concept has_columns = (Found == Expected);

namespace detail {

template <std::size_t Found, std::size_t Expected>
constexpr void check_columns() {
    static_assert(has_columns<Found, Expected>,
                  "view_features: the matrix has more or fewer columns than features asked for; has_columns "
                  "shows those of the matrix and those asked for");
}

} // namespace detail

/// Views a matrix of samples × features, which must outlive the view, as feature rows. Throws
/// std::invalid_argument if there are gaps between its rows, or if it has another number of features, or
/// none.
template <std::size_t Features, eigen_dense M>
[[nodiscard]] feature_rows<Features> view_features(M&& matrix) {
    using type = std::remove_cvref_t<M>;
    static_assert(std::is_same_v<typename type::Scalar, float>,
                  "view_features: features are of type float; convert them with cast<float>()");
    if constexpr (type::ColsAtCompileTime != Eigen::Dynamic && Features != dynamic_features)
        detail::check_columns<static_cast<std::size_t>(type::ColsAtCompileTime), Features>();
    return feature_rows<Features>(view_elements<std::dynamic_extent>(std::forward<M>(matrix)),
                                  static_cast<std::size_t>(matrix.cols()));
}
/// As above, with as many features as the matrix has columns; a constant if that is one.
template <eigen_dense M>
[[nodiscard]] auto view_features(M&& matrix) {
    constexpr int columns = std::remove_cvref_t<M>::ColsAtCompileTime;
    constexpr std::size_t features =
        columns == Eigen::Dynamic ? dynamic_features : static_cast<std::size_t>(columns);
    return view_features<features>(std::forward<M>(matrix));
}

/// Maps feature rows as a matrix of samples × features. What they view must outlive the map.
template <std::size_t Features>
[[nodiscard]] auto map_features(feature_rows<Features> rows) noexcept {
    using matrix = row_major_matrix<float, Eigen::Dynamic, detail::eigen_size<Features>>;
    return Eigen::Map<const matrix>(rows.values().data(), static_cast<Eigen::Index>(rows.size()),
                                    static_cast<Eigen::Index>(rows.features()));
}

// Frames. A row-major matrix of rows × columns is a frame of shape{rows, columns} in the same memory. A frame
// of several channels is a matrix of (channels · rows) × columns: its planes, one below the other. A vector
// of `size()` coefficients is a frame too, such as one row of a matrix with one frame per row.
//
//     Eigen::Matrix<float, 28, 50, Eigen::RowMajor> pressure;        // or frame_matrix<float, shape{28, 50}>
//     network.infer(view_frame(pressure), logits);               // sizes compared when compiling
//     Eigen::Matrix<float, -1, -1, Eigen::RowMajor> cells(28, 50);
//     network.infer(view_frame<shape{28, 50}>(cells), logits);   // compared when called

/// The type of a matrix whose memory is a frame of a shape.
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
    // Sizes that are known at run time are compared then.
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

/// Whether the type of a matrix determines its size and strides.
template <class M>
inline constexpr bool frame_is_known = M::SizeAtCompileTime != Eigen::Dynamic && strides_are_known<M>;

template <class M, shape Shape>
[[noreturn]] void refuse_frame(const M& matrix) {
    detail::throw_invalid_argument(
        {"frame: expected a matrix of ", Shape.channels * Shape.rows, " x ", Shape.columns,
         " stored row by row without gaps, found ", std::to_string(matrix.rows()), " x ",
         std::to_string(matrix.cols()),
         has_frame_size<M, Shape>(matrix) ? " with gaps between its rows or coefficients" : ""});
}

template <class M>
[[nodiscard]] constexpr shape frame_shape() {
    static_assert(
        M::SizeAtCompileTime != Eigen::Dynamic,
        "view_frame: the size of the matrix is known at run time only; name the shape of the frame, as in "
        "view_frame<shape{28, 50}>(matrix)");
    if (M::SizeAtCompileTime == Eigen::Dynamic)
        return {};
    return {static_cast<std::size_t>(M::RowsAtCompileTime), static_cast<std::size_t>(M::ColsAtCompileTime)};
}

} // namespace detail

/// Views a matrix, which must outlive the view, as a frame of a shape. Returns std::nullopt if its size at
/// run time is another, or if there are gaps between its rows. For control loops.
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

/// As try_view_frame, but throws std::invalid_argument. It never throws if the type of the matrix determines
/// its size and strides.
template <shape Shape, eigen_dense M>
[[nodiscard]] auto view_frame(M&& matrix) noexcept(detail::frame_is_known<std::remove_cvref_t<M>>)
    -> tensor_view<detail::coefficient<M>, Shape> {
    const auto view = try_view_frame<Shape>(std::forward<M>(matrix));
    if constexpr (!detail::frame_is_known<std::remove_cvref_t<M>>)
        if (!view)
            detail::refuse_frame<std::remove_cvref_t<M>, Shape>(matrix);
    return *view;
}
/// Views a matrix of fixed size as a frame of one channel.
template <eigen_dense M>
[[nodiscard]] auto view_frame(M&& matrix) noexcept(detail::frame_is_known<std::remove_cvref_t<M>>) {
    return view_frame<detail::frame_shape<std::remove_cvref_t<M>>()>(std::forward<M>(matrix));
}

/// Copies what cannot be viewed: column-major matrices, blocks, expressions. Throws std::invalid_argument if
/// the size at run time is another.
template <shape Shape, eigen_dense M>
[[nodiscard]] auto copy_frame(const M& matrix) -> tensor<typename M::Scalar, Shape> {
    detail::check_frame_size<M, Shape>();
    if (!detail::has_frame_size<M, Shape>(matrix))
        detail::throw_invalid_argument({"frame: expected a matrix of ", Shape.channels * Shape.rows, " x ",
                                        Shape.columns, ", found ", std::to_string(matrix.rows()), " x ",
                                        std::to_string(matrix.cols())});
    tensor<typename M::Scalar, Shape> frame;
    // A vector stays a vector: Eigen does not assign it to a matrix of dynamic size.
    constexpr int rows = M::RowsAtCompileTime, columns = M::ColsAtCompileTime;
    using copied = row_major_matrix<typename M::Scalar, rows, columns>;
    Eigen::Map<copied> copy(frame.data(), matrix.rows(), matrix.cols());
    if constexpr (std::is_base_of_v<Eigen::ArrayBase<M>, M>)
        copy.array() = matrix;
    else
        copy = matrix;
    return frame;
}

namespace detail {

/// A `tensor` that is no temporary.
template <class Tensor>
concept lasting_tensor = std::is_lvalue_reference_v<Tensor> && requires(Tensor frame) { frame.view(); };

} // namespace detail

/// Maps a frame, which must outlive the map, as a matrix of (channels · rows) × columns.
template <class T, shape Shape>
[[nodiscard]] auto map_frame(tensor_view<T, Shape> frame) noexcept {
    using matrix = frame_matrix<std::remove_const_t<T>, Shape>;
    return Eigen::Map<std::conditional_t<std::is_const_v<T>, const matrix, matrix>>(frame.data());
}
/// As above, for a `tensor`, which must outlive the map.
template <class Tensor>
    requires detail::lasting_tensor<Tensor>
[[nodiscard]] auto map_frame(Tensor&& frame) noexcept {
    return map_frame(frame.view());
}

/// Maps the planes of a frame or feature map, which must outlive the maps: a matrix of rows × columns for
/// each channel.
template <class T, shape Shape>
[[nodiscard]] auto map_planes(tensor_view<T, Shape> frame) noexcept {
    constexpr shape plane{Shape.rows, Shape.columns};
    return [&]<std::size_t... Channel>(std::index_sequence<Channel...>) {
        return std::array{map_frame(tensor_view<T, plane>(frame.data() + Channel * plane.size()))...};
    }(std::make_index_sequence<Shape.channels>());
}
/// As above, for a `tensor`, which must outlive the maps.
template <class Tensor>
    requires detail::lasting_tensor<Tensor>
[[nodiscard]] auto map_planes(Tensor&& frame) noexcept {
    return map_planes(frame.view());
}

/// Maps the frame of a recording or of a live sensor as a matrix of rows × columns. The map is valid as long
/// as the cells: for the frame of a decoder until its next call. Throws std::invalid_argument unless there
/// are rows × columns cells.
[[nodiscard]] inline auto map_frame(const frame_view& frame) {
    if (frame.cells.size() != frame.rows * frame.columns)
        detail::throw_invalid_argument(
            {"frame: expected ", frame.rows, " x ", frame.columns, " cells, found ", frame.cells.size()});
    return Eigen::Map<const row_major_matrix<float, Eigen::Dynamic, Eigen::Dynamic>>(
        frame.cells.data(), static_cast<Eigen::Index>(frame.rows), static_cast<Eigen::Index>(frame.columns));
}

/// Views a row-major float matrix, which must outlive the view, as the frame of a decoder. Throws
/// std::invalid_argument if there are gaps between its rows.
template <eigen_dense M>
[[nodiscard]] frame_view view_sensor_frame(M&& matrix, std::uint64_t number = 0,
                                           std::optional<double> seconds = std::nullopt) {
    static_assert(std::is_same_v<typename std::remove_cvref_t<M>::Scalar, float>,
                  "view_sensor_frame: cells are of type float; convert them with cast<float>()");
    const std::span<const float> cells = view_elements<std::dynamic_extent>(std::forward<M>(matrix));
    return {number, seconds, static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols()),
            cells};
}

}} // namespace tactnet
