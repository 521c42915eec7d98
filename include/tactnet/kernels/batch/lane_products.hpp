#pragma once

#include <tactnet/detail/round_up.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Products of a matrix and one group of samples, which lie side by side in the lanes: no sum runs across
// lanes, and a sample's result does not depend on its neighbours. Every sum is taken in one fixed order.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Where the elements of a matrix lie: (row, column) at row · `row` + column · `column`. A transposed matrix
/// is the same memory with the two exchanged.
struct matrix_layout {
    std::size_t row, column;
};

/// Rows that are summed at once: each input is read once for all of them, their chains of multiply-adds hide
/// each other's latency, and all fit into 16 registers.
inline constexpr std::size_t lane_product_rows = 12;

/// put(row, sum) for every row of matrix (Rows × Columns) · values, where `values` holds one vector for each
/// column of the matrix.
template <std::size_t Rows, std::size_t Columns, matrix_layout Layout, class T, class Put>
[[gnu::flatten]] void lane_product(const T* matrix, const T* values, Put&& put) {
    // Blocks as equal as can be: a single row left over would wait for itself.
    constexpr std::size_t passes = ceil_div(Rows, lane_product_rows);
    blocked<Rows, ceil_div(Rows, passes)>([&](auto block, std::size_t first) {
        constexpr std::size_t rows = block;
        const T* from = matrix + first * Layout.row;
        std::array<vector<T>, rows> sums;
#pragma GCC unroll 64
        for (std::size_t r = 0; r < rows; ++r)
            sums[r] = vector<T>(T{});
        for (std::size_t c = 0; c < Columns; ++c, from += Layout.column) {
            const vector<T> value = load(values + c * lanes<T>);
#pragma GCC unroll 64
            for (std::size_t r = 0; r < rows; ++r)
                sums[r] = multiply_add(vector<T>(from[r * Layout.row]), value, sums[r]);
        }
#pragma GCC unroll 64
        for (std::size_t r = 0; r < rows; ++r)
            put(first + r, sums[r]);
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
