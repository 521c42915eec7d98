#pragma once

#include <tactnet/eigen/memory.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <ranges>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

// Logits and other runs of numbers: what this library takes as a std::span is in Eigen a vector, or a matrix
// with a row for each frame.
//
//     Eigen::Vector<float, 22> logits;
//     network.infer(frame, view_elements(logits));

namespace tactnet {
inline namespace TACTNET_ARCH {

template <std::size_t Found, std::size_t Expected>
concept has_elements = (Found == Expected);

namespace detail {

template <class M>
inline constexpr std::size_t matrix_elements = M::SizeAtCompileTime == Eigen::Dynamic
                                                   ? std::dynamic_extent
                                                   : static_cast<std::size_t>(M::SizeAtCompileTime);

template <std::size_t Found, std::size_t Expected>
constexpr void check_elements() {
    static_assert(has_elements<Found, Expected>,
                  "elements: the matrix has more or fewer coefficients than asked for; has_elements shows "
                  "those of the matrix and those asked for");
}

} // namespace detail

/// The coefficients of a vector or of a matrix stored row by row, without a copy; the matrix must outlive
/// them. For control loops: nothing if there are not as many as asked for, or gaps between them.
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

/// The same; throws std::invalid_argument in place of nothing. For a matrix whose type tells all, it never
/// throws.
template <std::size_t Count, eigen_dense M>
[[nodiscard]] auto view_elements(M&& matrix) noexcept(detail::matrix_elements<std::remove_cvref_t<M>> ==
                                                          Count &&
                                                      detail::strides_are_known<std::remove_cvref_t<M>>)
    -> std::span<detail::coefficient<M>, Count> {
    const auto view = try_view_elements<Count>(std::forward<M>(matrix));
    if constexpr (detail::matrix_elements<std::remove_cvref_t<M>> != Count ||
                  !detail::strides_are_known<std::remove_cvref_t<M>>)
        if (!view)
            throw std::invalid_argument("elements: expected " +
                                        (Count == std::dynamic_extent
                                             ? std::string("coefficients")
                                             : std::to_string(Count) + " coefficients") +
                                        " without gaps, found " + std::to_string(matrix.size()) +
                                        (detail::lies_row_by_row(matrix) ? "" : " with gaps between them"));
    return *view;
}
/// As many as the matrix has: known when compiling if its size is.
template <eigen_dense M>
[[nodiscard]] auto view_elements(M&& matrix) noexcept(
    noexcept(view_elements<detail::matrix_elements<std::remove_cvref_t<M>>>(std::forward<M>(matrix)))) {
    return view_elements<detail::matrix_elements<std::remove_cvref_t<M>>>(std::forward<M>(matrix));
}

/// Numbers in memory (a std::span, a std::array, a std::vector, which must outlive it) as a column vector.
template <std::ranges::contiguous_range R>
    requires std::ranges::borrowed_range<R>
[[nodiscard]] auto map_vector(R&& numbers) {
    const std::span all(numbers);
    using element = typename decltype(all)::element_type;
    using vector = Eigen::Matrix<std::remove_const_t<element>, detail::eigen_size<decltype(all)::extent>, 1>;
    return Eigen::Map<std::conditional_t<std::is_const_v<element>, const vector, vector>>(
        all.data(), static_cast<Eigen::Index>(all.size()));
}

/// The same as a matrix with rows of so many numbers, such as the logits of a batch. Throws
/// std::invalid_argument unless they are a whole number of rows.
template <std::size_t Columns, std::ranges::contiguous_range R>
    requires std::ranges::borrowed_range<R>
[[nodiscard]] auto map_rows(R&& numbers) {
    static_assert(Columns > 0, "map_rows: a row has at least one number");
    const std::span all(numbers);
    if (all.size() % Columns != 0)
        throw std::invalid_argument("rows: expected whole rows of " + std::to_string(Columns) +
                                    " numbers, found " + std::to_string(all.size()) + " numbers");
    using element = typename decltype(all)::element_type;
    using matrix = row_major_matrix<std::remove_const_t<element>, Eigen::Dynamic, static_cast<int>(Columns)>;
    return Eigen::Map<std::conditional_t<std::is_const_v<element>, const matrix, matrix>>(
        all.data(), static_cast<Eigen::Index>(all.size() / Columns), static_cast<Eigen::Index>(Columns));
}

} // namespace TACTNET_ARCH
} // namespace tactnet
