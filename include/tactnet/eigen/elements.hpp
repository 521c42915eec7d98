#pragma once

#include <tactnet/eigen/memory.hpp>
#include <tactnet/text/message.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

// Logits, parameters and other sequences of numbers. Where this library takes a std::span, Eigen has a
// vector, or a matrix with a row for each frame.
//
//     Eigen::Vector<float, 22> logits;
//     network.infer(frame, view_elements(logits));

namespace tactnet { inline namespace TACTNET_ARCH {

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
