#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/direct_convolution.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// The weight gradient of a convolution with many input channels. Small maps with many channels have more
// weights than products per weight, so that sums across the lanes would take most of the time
// (direct_gradient.hpp). Here a tile of the input is transposed, so that a vector holds channels of one
// sample: each lane is then a weight of its own.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Adds the products of one pixel's samples to a register block of weights: sums[n][v] += numbers[n][sample]
/// × values[sample][v]. From one row of numbers to the next it is `stride` elements.
template <std::size_t Numbers, std::size_t Vectors, class T>
[[gnu::always_inline]] inline void
add_sample_products(std::array<std::array<vector<T>, Vectors>, Numbers>& sums, const T* values,
                    const T* numbers, std::size_t stride) {
    constexpr std::size_t width = lanes<T>;
    for (std::size_t sample = 0; sample < width; ++sample) {
        std::array<vector<T>, Vectors> x;
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            x[v] = load(values + (sample * Vectors + v) * width);
#pragma GCC unroll 64
        for (std::size_t n = 0; n < Numbers; ++n) {
            const vector<T> number(numbers[n * stride + sample]);
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                sums[n][v] = multiply_add(number, x[v], sums[n][v]);
        }
    }
}

/// The weight gradient by taps, where channels fill whole vectors.
template <batch_convolution C, class T>
struct channel_gradient {
    static constexpr const char* name = "channels in lanes";
    /// The bytes of one row of the input, transposed for so many vectors of channels.
    static constexpr std::size_t row_bytes(std::size_t vectors_of_block) {
        return C.input.columns * lanes<T> * vectors_of_block * lanes<T> * sizeof(T);
    }
    /// The first-level cache. Not the configured size (caches.hpp): trainings have the same bits on all
    /// cores, and a row that does not fit is summed in another order.
    static constexpr std::size_t cache_bytes = 32 * 1024;
    static constexpr bool applicable = C.groups == 1 && lanes<T> > 1 && C.input.channels % lanes<T> == 0 &&
                                       row_bytes(1) <= cache_bytes;
    static constexpr std::size_t vectors = C.input.channels / lanes<T>;
    /// A register block: vectors of channels × filters.
    static constexpr std::size_t block_vectors = vectors > 1 && row_bytes(2) <= cache_bytes ? 2 : 1;
    static constexpr std::size_t block_filters =
        std::min<std::size_t>(max_block_sums / block_vectors, C.output.channels);
    /// Rows of the transposed input that fit into half of the cache, but at least one.
    static constexpr std::size_t tile_rows =
        std::clamp<std::size_t>(cache_bytes / 2 / row_bytes(block_vectors), 1, C.input.rows);
    static constexpr std::size_t half_products = direct_gradient_cost(C, ceil_div(C.output.rows, tile_rows));
    /// Pieces of work write different weights: they may run on different threads. For each block of channels
    /// there are blocks of filters.
    static constexpr std::size_t filter_blocks = ceil_div(C.output.channels, block_filters);
    static constexpr std::size_t pieces = ceil_div(vectors, block_vectors) * filter_blocks;
    static constexpr std::size_t totals = C.weights();
    static constexpr std::size_t workspace_elements = tile_rows * row_bytes(block_vectors) / sizeof(T);

    /// The index of a weight's sum.
    static constexpr std::size_t place(std::size_t filter, std::size_t channel, std::size_t row,
                                       std::size_t column) {
        return ((filter * C.kernel.rows + row) * C.kernel.columns + column) * C.input.channels + channel;
    }

    /// sums[place(…)] += the gradient of one lane block, for the pieces [begin, end).
    static void add(const T* input, const T* gradient, double* sums, T* workspace, std::size_t begin,
                    std::size_t end) {
        constexpr std::size_t width = lanes<T>;
        blocked<vectors, block_vectors>([&](auto count, std::size_t first_vector) {
            const std::size_t first_piece = first_vector / block_vectors * filter_blocks;
            if (begin == end || first_piece + filter_blocks <= begin || first_piece >= end)
                return;
            for (std::size_t y = 0; y < C.input.rows; y += tile_rows) {
                const std::size_t end_row = std::min(y + tile_rows, C.input.rows);
                for (std::size_t pixel = y * C.input.columns; pixel < end_row * C.input.columns; ++pixel)
                    for (std::size_t v = 0; v < count; ++v)
                        transpose(input + ((first_vector + v) * width * C.input.area() + pixel) * width,
                                  C.input.area() * width,
                                  workspace + ((pixel - y * C.input.columns) * width * count + v) * width,
                                  count * width);
                blocked<C.output.channels, block_filters>([&](auto filters, std::size_t first_filter) {
                    const std::size_t piece = first_piece + first_filter / block_filters;
                    if (piece >= begin && piece < end)
                        add_tile<filters, count>(gradient + first_filter * C.output.area() * width, workspace,
                                                 y, end_row,
                                                 sums + place(first_filter, first_vector * width, 0, 0));
                });
            }
        });
    }
    /// gradients[filter][channel][row][column] from the sums.
    static void finish(const double* sums, T* gradients) {
        for (std::size_t filter = 0; filter < C.output.channels; ++filter)
            for (std::size_t channel = 0; channel < C.input.channels; ++channel)
                for (std::size_t row = 0; row < C.kernel.rows; ++row)
                    for (std::size_t column = 0; column < C.kernel.columns; ++column)
                        *gradients++ = static_cast<T>(sums[place(filter, channel, row, column)]);
    }

private:
    /// Accumulates all taps of one tile of input rows, for one block of channels and filters.
    template <std::size_t Filters, std::size_t Vectors>
    [[gnu::flatten]] static void add_tile(const T* gradient, const T* transposed, std::size_t begin_row,
                                          std::size_t end_row, double* sums_of_block) {
        constexpr std::size_t width = lanes<T>, row_elements = C.input.columns * width * Vectors * width;
        for (std::size_t row = 0; row < C.kernel.rows; ++row)
            for (std::size_t column = 0; column < C.kernel.columns; ++column) {
                std::array<std::array<vector<T>, Vectors>, Filters> sums;
#pragma GCC unroll 64
                for (std::size_t f = 0; f < Filters; ++f)
                    sums[f].fill(vector<T>(T{}));
                for (std::size_t y = 0; y < C.output.rows; ++y) {
                    const std::size_t from = y * C.stride.rows + row - static_cast<std::size_t>(C.top);
                    if (from >= begin_row && from < end_row)
                        add_row(sums, gradient + y * C.output.columns * width,
                                transposed + (from - begin_row) * row_elements, column);
                }
#pragma GCC unroll 64
                for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
                    for (std::size_t v = 0; v < Vectors; ++v)
                        add_each_lane<T>(sums_of_block + place(f, v * width, row, column), sums[f][v]);
                }
            }
    }
    /// Adds the products of one tap over one row of outputs and the row of the input that it reads.
    template <std::size_t Filters, std::size_t Vectors>
    [[gnu::always_inline]] static void add_row(std::array<std::array<vector<T>, Vectors>, Filters>& sums,
                                               const T* gradient, const T* transposed,
                                               std::size_t kernel_column) {
        constexpr std::size_t width = lanes<T>, left = static_cast<std::size_t>(C.left);
        for (std::size_t x = 0; x < C.output.columns; ++x) {
            const std::size_t pixel = x * C.stride.columns + kernel_column - left;
            if (pixel < C.input.columns) // else on padding; on the left it wraps
                add_sample_products(sums, transposed + pixel * width * Vectors * width, gradient + x * width,
                                    C.output.area() * width);
        }
    }
};

}}} // namespace tactnet::kernels
