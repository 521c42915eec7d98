#pragma once

#include <tactnet/detail/config.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Solves matrix · x = right in place for all columns of `right`, and replaces `matrix` by its inverse. Uses
/// the Cholesky decomposition and no heap. Both are row-major; `matrix` (Size × Size) is symmetric and
/// positive definite, and only its lower half is read.
template <std::size_t Size, std::size_t Columns>
void solve_and_invert(double* matrix, double* right) {
    constexpr auto size = static_cast<int>(Size), columns = static_cast<int>(Columns);
    // Eigen requires column-major order for matrices of one column.
    constexpr int square_order = size == 1 ? Eigen::ColMajor : Eigen::RowMajor;
    constexpr int right_order = columns == 1 ? Eigen::ColMajor : Eigen::RowMajor;
    using square = Eigen::Matrix<double, size, size, square_order>;
    Eigen::Map<square> inverse(matrix);
    Eigen::Map<Eigen::Matrix<double, size, columns, right_order>> solution(right);
    const Eigen::LLT<square> factors(inverse);
    factors.solveInPlace(solution);
    inverse.setIdentity();
    factors.solveInPlace(inverse);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
