#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>

// The product of a matrix and a lane block. No sum runs across the lanes, so a sample's result does not
// depend on its neighbours, and each sum has one fixed order.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The strides of a matrix: element (r, c) is at r · `row` + c · `column`. Exchanging both transposes the
/// matrix.
struct matrix_layout {
    std::size_t row, column;
};

/// Rows that are summed at once: they share each load of an input, hide each other's latency and fit into 16
/// registers.
inline constexpr std::size_t lane_product_rows = 12;

/// Calls put(row, sum) for each row of the product matrix (Rows × Columns) · values, where `values` holds one
/// vector per column.
template <std::size_t Rows, std::size_t Columns, matrix_layout Layout, class T, class Put>
[[gnu::flatten]] void lane_product(const T* matrix, const T* values, Put&& put) {
    // Blocks of equal size: a single remaining row could not hide its latency.
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

}}} // namespace tactnet::kernels
