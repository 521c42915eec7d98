#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// The gradient of a convolution with respect to its weights, for inputs of many channels. Small maps of many
// channels have more weights than products for each, and sums across lanes would take most of the time (see
// convolution_gradient.hpp). Here a tile of the input is turned, so that a vector holds channels of one
// sample: then every lane is a weight of its own.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Whether channels fill whole vectors, and how the work is blocked then.
template <sliding_window W, std::size_t Filters, class T>
struct channel_gradient_plan {
    /// One row of the input, turned for so many vectors of channels.
    static constexpr std::size_t row_bytes(std::size_t vectors_of_block) {
        return W.input.columns * lanes<T> * vectors_of_block * lanes<T> * sizeof(T);
    }
    /// Of the first level. Not that of the configuration (caches.hpp): trainings have the same bits on all
    /// cores, and what does not fit is summed in another order.
    static constexpr std::size_t cache_bytes = 32 * 1024;
    static constexpr bool fits = lanes<T> > 1 && W.input.channels % lanes<T> == 0 &&
                                 row_bytes(1) <= cache_bytes;
    static constexpr std::size_t vectors = W.input.channels / lanes<T>;
    /// Registers of a block: vectors of channels × filters.
    static constexpr std::size_t block_vectors = vectors > 1 && row_bytes(2) <= cache_bytes ? 2 : 1;
    static constexpr std::size_t block_filters =
        std::min<std::size_t>(max_block_sums / block_vectors, Filters);
    /// Rows of the turned input that stay in half of the cache, but at least one.
    static constexpr std::size_t tile_rows =
        std::clamp<std::size_t>(cache_bytes / 2 / row_bytes(block_vectors), 1, W.input.rows);
    /// Elements that a thread needs for a turned tile.
    static constexpr std::size_t scratch = tile_rows * row_bytes(block_vectors) / sizeof(T);
    /// Pieces of work that write different weights, and so may run on different threads: for each block of
    /// channels, blocks of filters.
    static constexpr std::size_t filter_blocks = (Filters + block_filters - 1) / block_filters;
    static constexpr std::size_t pieces = (vectors + block_vectors - 1) / block_vectors * filter_blocks;
    /// Where the sum of a weight is kept.
    static constexpr std::size_t place(std::size_t filter, std::size_t channel, std::size_t row,
                                       std::size_t column) {
        return ((filter * W.kernel.rows + row) * W.kernel.columns + column) * W.input.channels + channel;
    }
};

/// Adds the products of one tap over the output row y: `turned` is the row of the input that it reads.
template <sliding_window W, std::size_t Filters, std::size_t Vectors, class T>
[[gnu::always_inline]] inline void add_row_products(std::array<std::array<vector<T>, Vectors>, Filters>& sums,
                                                    const T* gradient, const T* turned, std::size_t y,
                                                    std::size_t kernel_column) {
    constexpr std::size_t width = lanes<T>, columns = W.output_columns(), plane = W.output_rows() * columns;
    for (std::size_t x = 0; x < columns; ++x) {
        const std::size_t pixel = x * W.stride.columns + kernel_column - W.left;
        if (pixel >= W.input.columns) // on padding, also on the left, where it wraps
            continue;
        const T* g = gradient + (y * columns + x) * width;
        const T* from = turned + pixel * width * Vectors * width;
        for (std::size_t sample = 0; sample < width; ++sample) {
            std::array<vector<T>, Vectors> channels;
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                channels[v] = load(from + (sample * Vectors + v) * width);
#pragma GCC unroll 64
            for (std::size_t f = 0; f < Filters; ++f) {
                const vector<T> value(g[f * plane * width + sample]);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < Vectors; ++v)
                    sums[f][v] = multiply_add(value, channels[v], sums[f][v]);
            }
        }
    }
}

/// One tile of input rows, one block of channels and filters: all taps.
template <sliding_window W, std::size_t Filters, std::size_t Vectors, class T>
[[gnu::flatten]] inline void add_tile(const T* gradient, const T* turned, std::size_t begin_row,
                                      std::size_t end_row, double* totals) {
    using plan = channel_gradient_plan<W, Filters, T>;
    constexpr std::size_t row_elements = W.input.columns * lanes<T> * Vectors * lanes<T>;
    for (std::size_t row = 0; row < W.kernel.rows; ++row)
        for (std::size_t column = 0; column < W.kernel.columns; ++column) {
            std::array<std::array<vector<T>, Vectors>, Filters> sums;
#pragma GCC unroll 64
            for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
                for (std::size_t v = 0; v < Vectors; ++v)
                    sums[f][v] = vector<T>(T{});
            }
            for (std::size_t y = 0; y < W.output_rows(); ++y) {
                const std::size_t from = y * W.stride.rows + row - W.top;
                if (from >= begin_row && from < end_row)
                    add_row_products<W>(sums, gradient, turned + (from - begin_row) * row_elements, y,
                                        column);
            }
#pragma GCC unroll 64
            for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
                for (std::size_t v = 0; v < Vectors; ++v)
                    add_each_lane<T>(totals + plan::place(f, v * lanes<T>, row, column), sums[f][v]);
            }
        }
}

/// totals[plan::place(…)] += the weight gradient of one group, for the pieces [begin, end).
template <sliding_window W, std::size_t Filters, class T>
void add_channel_gradient(const T* input, const T* gradient, double* totals, T* scratch, std::size_t begin,
                          std::size_t end) {
    using plan = channel_gradient_plan<W, Filters, T>;
    constexpr std::size_t width = lanes<T>, plane = W.output_rows() * W.output_columns();
    blocked<plan::vectors, plan::block_vectors>([&](auto vectors, std::size_t first_vector) {
        const std::size_t first_piece = first_vector / plan::block_vectors * plan::filter_blocks;
        if (begin == end || first_piece + plan::filter_blocks <= begin || first_piece >= end)
            return;
        for (std::size_t y = 0; y < W.input.rows; y += plan::tile_rows) {
            const std::size_t end_row = std::min(y + plan::tile_rows, W.input.rows);
            for (std::size_t pixel = y * W.input.columns; pixel < end_row * W.input.columns; ++pixel)
                for (std::size_t v = 0; v < vectors; ++v)
                    transpose(input + ((first_vector + v) * width * W.input.area() + pixel) * width,
                              W.input.area() * width,
                              scratch + ((pixel - y * W.input.columns) * width * vectors + v) * width,
                              vectors * width);
            blocked<Filters, plan::block_filters>([&](auto filters, std::size_t first_filter) {
                const std::size_t piece = first_piece + first_filter / plan::block_filters;
                if (piece < begin || piece >= end)
                    return;
                add_tile<W, filters, vectors>(gradient + first_filter * plane * width, scratch, y, end_row,
                                              totals + plan::place(first_filter, first_vector * width, 0, 0));
            });
        }
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
