#pragma once

#include <tactnet/detail/config.hpp>

#include <Eigen/Core>

#include <cstddef>

// Matrix products, by Eigen. All matrices are row-major and dense.

namespace tactnet::inline TACTNET_ARCH {

template <class T>
using row_major = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A row-major matrix over someone else's memory. T may be const.
template <class T>
[[nodiscard]] inline auto as_matrix(T* data, std::size_t rows, std::size_t columns) {
    const auto r = static_cast<Eigen::Index>(rows), c = static_cast<Eigen::Index>(columns);
    if constexpr (std::is_const_v<T>)
        return Eigen::Map<const row_major<std::remove_const_t<T>>>(data, r, c);
    else
        return Eigen::Map<row_major<T>>(data, r, c);
}

/// c (m × n) = a (m × k) · b (k × n)
template <class T>
void multiply(const T* a, const T* b, T* c, std::size_t m, std::size_t k, std::size_t n) {
    as_matrix(c, m, n).noalias() = as_matrix(a, m, k) * as_matrix(b, k, n);
}

/// c (m × n) = aᵀ · b, with a (k × m) and b (k × n)
template <class T>
void multiply_transposed_left(const T* a, const T* b, T* c, std::size_t m, std::size_t k, std::size_t n) {
    as_matrix(c, m, n).noalias() = as_matrix(a, k, m).transpose() * as_matrix(b, k, n);
}

/// c (m × n) = a · bᵀ, with a (m × k) and b (n × k)
template <class T>
void multiply_transposed_right(const T* a, const T* b, T* c, std::size_t m, std::size_t k, std::size_t n) {
    as_matrix(c, m, n).noalias() = as_matrix(a, m, k) * as_matrix(b, n, k).transpose();
}

} // namespace tactnet
