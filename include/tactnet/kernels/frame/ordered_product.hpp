#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/method_list.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>

// A matrix times the numbers of one frame, outputs side by side in vectors. The terms of each sum are added
// in the order of the inputs, then the bias: bit-identical with the lane_product of a batch.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A matrix for ordered products: `Rows` outputs in whole vectors, `Inputs` columns.
template <std::size_t Rows, std::size_t Inputs>
struct ordered_product {
    static constexpr std::size_t padded_rows = padded_size<float>(Rows); ///< elements of an output
    static constexpr std::size_t packed_elements = padded_rows * (Inputs + 1);

    /// Packs weight(row, input) and bias(row). Padding rows are zero.
    static constexpr void pack(const auto& weight, const auto& bias, float* packed) {
        for (std::size_t row = 0; row < padded_rows; ++row)
            packed[row] = row < Rows ? bias(row) : 0.0F;
        const auto tap = [&](std::size_t row, std::size_t input, std::size_t, std::size_t) {
            return weight(row, input);
        };
        pack_taps(tap, Rows, padded_rows, block * lanes<float>, Inputs, 1, packed + padded_rows);
    }
    /// sums[row] = Σ weights[row][input] · from[input] + bias[row]; `sums` is aligned.
    [[gnu::flatten]] static void run(const float* packed, const float* from, float* sums) noexcept {
        blocked<vectors, block>([&](auto count, std::size_t first) {
            constexpr std::size_t size = count;
            const float* weights = packed + padded_rows + first * lanes<float> * Inputs;
            std::array<vector<float>, size> sum;
#pragma GCC unroll 64
            for (std::size_t v = 0; v < size; ++v)
                sum[v] = vector<float>(0.0F);
            for (std::size_t i = 0; i < Inputs; ++i, weights += size * lanes<float>) {
                const vector<float> x(from[i]);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < size; ++v)
                    sum[v] = multiply_add(load(weights + v * lanes<float>), x, sum[v]);
            }
#pragma GCC unroll 64
            for (std::size_t v = 0; v < size; ++v) {
                const std::size_t at = (first + v) * lanes<float>;
                store(sums + at, sum[v] + load(packed + at));
            }
        });
    }

private:
    static constexpr std::size_t vectors = padded_rows / lanes<float>,
                                 block = ceil_div(vectors, ceil_div(vectors, max_block_sums));
};

}}} // namespace tactnet::kernels
