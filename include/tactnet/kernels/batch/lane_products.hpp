#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
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

// The gradients of a matrix and its biases, by which lane blocks were multiplied.

namespace detail {

/// Adds the gradients of the weights between up to `lanes<T>` inputs and all outputs, summed over the samples
/// of one lane block.
template <std::size_t Outputs, class T>
void add_weight_gradients(const T* out_gradient, const T* in, std::size_t count, double* totals) {
    alignas(vector_alignment) std::array<T, lanes<T> * lanes<T>> turned;
    transpose(in, count, turned.data());
    lane_product<Outputs, lanes<T>, matrix_layout{lanes<T>, 1}>(
        out_gradient, turned.data(),
        [&](std::size_t o, const vector<T>& sum) { add_each_lane<T>(totals + o * lanes<T>, sum); });
}

} // namespace detail

/// Sets weights[o · Inputs + i] = Σ out_gradient[o] · in[i] and biases[o] = Σ out_gradient[o] over the lanes
/// of the lane blocks 0 … count − 1, in this order: in_block(b) and gradient_block(b) point to a vector for
/// each input and output. Threads share the outputs for the biases, and the inputs, a vector at a time, for
/// the weights. `totals` is memory that grows as needed.
template <std::size_t Outputs, std::size_t Inputs, class T>
void sum_weight_gradients(thread_pool& threads, std::size_t count, const auto& in_block,
                          const auto& gradient_block, T* weights, T* biases, aligned_vector<double>& totals) {
    constexpr std::size_t vectors = padded_size<T>(Inputs) / lanes<T>;
    totals.resize(threads.threads() * Outputs * lanes<T>);
    threads.on_each_thread([&](thread_pool::share part) {
        for (std::size_t o = part.begin(Outputs); o < part.end(Outputs); ++o) {
            double bias = 0;
            for (std::size_t b = 0; b < count; ++b)
                bias += sum_terms<1, T>(1, [&](std::size_t) {
                    return std::array<vector<T>, 1>{load(gradient_block(b) + o * lanes<T>)};
                })[0];
            biases[o] = static_cast<T>(bias);
        }
        double* const own = totals.data() + part.index * Outputs * lanes<T>;
        for (std::size_t v = part.begin(vectors); v < part.end(vectors); ++v) {
            const std::size_t first = v * lanes<T>, inputs = std::min(lanes<T>, Inputs - first);
            std::fill_n(own, Outputs * lanes<T>, 0.0);
            for (std::size_t b = 0; b < count; ++b)
                detail::add_weight_gradients<Outputs, T>(gradient_block(b), in_block(b) + first * lanes<T>,
                                                         inputs, own);
            for (std::size_t o = 0; o < Outputs; ++o)
                for (std::size_t i = 0; i < inputs; ++i)
                    weights[o * Inputs + first + i] = static_cast<T>(own[o * lanes<T> + i]);
        }
    });
}

}}} // namespace tactnet::kernels
