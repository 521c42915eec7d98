#pragma once

#include <tactnet/eigen/elements.hpp>
#include <tactnet/svm/feature_rows.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <span>
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

}} // namespace tactnet
