#pragma once

#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/kernels/batch/tiles/tile_input.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// The gradient of a convolution with respect to its weights by tiles, for inputs of many channels: Gᵀ [Σ (Bᵀ
// d B) ∘ (A δ Aᵀ)] G, with d the input tile, δ the gradient of the outputs, and the sum over all tiles of all
// samples (Lavin and Gray, 2016, on convolutions by tiles; this is the same bilinear form with other
// arguments). Sums stay in the transformed domain until the end of a batch. As without tiles
// (batch/channel_gradient.hpp) a vector holds channels of one sample, so that every lane is a sum of its own.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Registers of a block of sums: vectors of channels × filters.
template <class T>
struct gradient_block {
    std::size_t vectors, filters;

    [[nodiscard]] static constexpr gradient_block of(const correlation& c) {
        const std::size_t vectors = c.input.channels > lanes<T> ? 2 : 1;
        return {vectors, std::min(most_block_sums / vectors, c.output.channels)};
    }
};

/// Bytes of one row of tiles, transformed, of one block.
template <class T>
[[nodiscard]] constexpr std::size_t bytes_of_tile_row(const correlation& c, extent outputs) {
    const group_tiles tiles = group_tiles::of(c, outputs);
    const auto block = gradient_block<T>::of(c);
    return tiles.elements() * tiles.columns * (block.vectors * lanes<T> + block.filters) * lanes<T> *
           sizeof(T);
}
/// Rows of tiles from the first transform to the last; their products are added up in the network's
/// precision. Not by a configured size of a cache: trainings have the same bits on all cores.
template <class T>
[[nodiscard]] constexpr std::size_t tile_rows_of_band(const correlation& c, extent outputs) {
    return std::clamp<std::size_t>(std::size_t{512} * 1024 / bytes_of_tile_row<T>(c, outputs), 1,
                                   group_tiles::of(c, outputs).rows);
}

/// Whether there is such a way: channels fill whole vectors, and a band stays in a near cache.
template <class T>
[[nodiscard]] constexpr bool tiled_gradient_possible(const correlation& c, extent outputs) {
    return lanes<T> > 1 && c.input.channels % lanes<T> == 0 && group_tile_possible(c, outputs) &&
           bytes_of_tile_row<T>(c, outputs) <= std::size_t{1024} * 1024;
}

/// How the gradient of a convolution's weights is blocked by tiles of so many outputs.
template <sliding_window W, std::size_t Filters, extent Outputs, class T>
struct tiled_gradient_plan {
    static constexpr correlation ahead = correlation::forward(W, Filters);
    static_assert(tiled_gradient_possible<T>(ahead, Outputs), "tiled_gradient_plan: there is no such way");
    static constexpr group_tiles tiles = group_tiles::of(ahead, Outputs);
    static constexpr std::size_t elements = tiles.elements();
    static constexpr std::size_t channels = W.input.channels, vectors = channels / lanes<T>;
    static constexpr std::size_t block_vectors = gradient_block<T>::of(ahead).vectors,
                                 block_filters = gradient_block<T>::of(ahead).filters;
    /// Pieces of work that write different sums, and so may run on different threads: for each block of
    /// channels, blocks of filters.
    static constexpr std::size_t filter_blocks = (Filters + block_filters - 1) / block_filters;
    static constexpr std::size_t vector_blocks = (vectors + block_vectors - 1) / block_vectors;
    static constexpr std::size_t pieces = vector_blocks * filter_blocks;

    static constexpr std::size_t band_rows = tile_rows_of_band<T>(ahead, Outputs),
                                 band_tiles = band_rows * tiles.columns;
    /// Rows of the input that a band reads, and their elements, turned.
    static constexpr std::size_t turned_rows =
        std::min((band_rows - 1) * Outputs.rows + tiles.side.rows, W.input.rows);
    static constexpr std::size_t planes = lanes<T> * block_vectors; ///< vectors of a pixel
    static constexpr std::size_t turned = turned_rows * W.input.columns * planes * lanes<T>;
    /// From one element of a tile to the next, of transformed inputs and gradients.
    static constexpr std::size_t input_distance = odd_lines<T>(band_tiles * planes * lanes<T>),
                                 gradient_distance = odd_lines<T>(band_tiles * block_filters * lanes<T>);
    /// Elements that a thread needs.
    static constexpr std::size_t scratch = turned + elements * (input_distance + gradient_distance);
    /// Sums, in the order of use: blocks of channels, of filters, then [element][filter][channel].
    static constexpr std::size_t totals = elements * Filters * channels;
    /// Of these, those before a block, whose channels fill so many vectors.
    static constexpr std::size_t totals_before(std::size_t first_vector, std::size_t first_filter,
                                               std::size_t vectors_of_block) {
        return elements * lanes<T> * (first_vector * Filters + first_filter * vectors_of_block);
    }
};

/// One element, one block of channels and filters, one band: totals[filter][channel] += Σ over tiles and
/// samples.
template <std::size_t Filters, std::size_t Vectors, class T>
[[gnu::always_inline]] inline void add_element(const T* input, const T* gradient, std::size_t tiles,
                                               double* totals) {
    constexpr std::size_t width = lanes<T>;
    std::array<std::array<vector<T>, Vectors>, Filters> sums;
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            sums[f][v] = vector<T>(T{});
    }
    for (std::size_t tile = 0; tile < tiles; ++tile, gradient += Filters * width)
        for (std::size_t sample = 0; sample < width; ++sample, input += Vectors * width) {
            std::array<vector<T>, Vectors> channels;
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                channels[v] = load(input + v * width);
#pragma GCC unroll 64
            for (std::size_t f = 0; f < Filters; ++f) {
                const vector<T> value(gradient[f * width + sample]);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < Vectors; ++v)
                    sums[f][v] = multiply_add(value, channels[v], sums[f][v]);
            }
        }
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            add_each_lane<T>(totals + (f * Vectors + v) * width, sums[f][v]);
    }
}

/// A δ Aᵀ of one tile of the outputs' gradient, of every plane: element e of plane p to
/// to[e · element_distance + p · lanes].
template <correlation C, extent Outputs, class T>
[[gnu::flatten, gnu::noinline]] void transform_gradient_tile(const T* gradient, std::size_t filters,
                                                             std::size_t tile, T* to,
                                                             std::size_t element_distance) {
    constexpr group_tiles tiles = group_tiles::of(C, Outputs);
    constexpr extent side = tiles.side;
    constexpr std::size_t width = lanes<T>;
    const auto top = static_cast<std::ptrdiff_t>(tile / tiles.columns * Outputs.rows),
               left = static_cast<std::ptrdiff_t>(tile % tiles.columns * Outputs.columns);
    for_each_plane(
        gradient, {filters, C.output.area() * width, width}, C.output.columns,
        pixel_square<Outputs>::at(top, left, C.output.rows, C.output.columns),
        [&](std::size_t plane, const T* from, std::size_t row,
            std::size_t pixel) __attribute__((always_inline)) {
            std::array<std::array<vector<T>, Outputs.columns>, side.rows> half;
#pragma GCC unroll 64
            for (std::size_t x = 0; x < Outputs.columns; ++x) {
                std::array<vector<T>, Outputs.rows> column;
#pragma GCC unroll 64
                for (std::size_t y = 0; y < Outputs.rows; ++y)
                    column[y] = load(from + y * row + x * pixel);
                const std::array<vector<T>, side.rows> line = detail::tile_gradient_line<side.rows>(column);
#pragma GCC unroll 64
                for (std::size_t y = 0; y < side.rows; ++y)
                    half[y][x] = line[y];
            }
            T* place = to + plane * width;
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side.rows; ++y) {
                const std::array<vector<T>, side.columns> line =
                    detail::tile_gradient_line<side.columns>(half[y]);
#pragma GCC unroll 64
                for (std::size_t x = 0; x < side.columns; ++x, place += element_distance)
                    store(place, line[x]);
            }
        });
}

/// totals[element][filter][channel] += the gradient of one group, for the pieces [begin, end).
template <sliding_window W, std::size_t Filters, extent Outputs, class T>
[[gnu::flatten]] void add_tiled_gradient(const T* input, const T* gradient, double* totals, T* scratch,
                                         std::size_t begin, std::size_t end) {
    using plan = tiled_gradient_plan<W, Filters, Outputs, T>;
    constexpr std::size_t width = lanes<T>, plane = W.output_rows() * W.output_columns();
    T* const transformed = scratch + plan::turned;
    T* const transformed_gradient = transformed + plan::elements * plan::input_distance;
    blocked<plan::vectors, plan::block_vectors>([&](auto vectors, std::size_t first_vector) {
        const std::size_t first_piece = first_vector / plan::block_vectors * plan::filter_blocks;
        if (first_piece + plan::filter_blocks <= begin || first_piece >= end)
            return;
        blocked<plan::tiles.rows, plan::band_rows>([&](auto rows, std::size_t first_row) {
            constexpr std::size_t tiles = rows * plan::tiles.columns, planes = width * vectors;
            // Rows of the input that these tiles read, turned.
            const auto top = static_cast<std::ptrdiff_t>(first_row * Outputs.rows) - plan::ahead.top;
            const auto pixel_row = static_cast<std::size_t>(std::max<std::ptrdiff_t>(top, 0));
            const std::size_t end_row = std::min(
                static_cast<std::size_t>(
                    top + static_cast<std::ptrdiff_t>((rows - 1) * Outputs.rows + plan::tiles.side.rows)),
                W.input.rows);
            for (std::size_t pixel = pixel_row * W.input.columns; pixel < end_row * W.input.columns; ++pixel)
                for (std::size_t v = 0; v < vectors; ++v)
                    transpose(input + ((first_vector + v) * width * W.input.area() + pixel) * width,
                              W.input.area() * width,
                              scratch + ((pixel - pixel_row * W.input.columns) * planes + v) * width,
                              vectors * width);
            for (std::size_t tile = 0; tile < tiles; ++tile)
                transform_input_tile<plan::ahead, Outputs>(
                    scratch, {planes, width, planes * width}, first_row * plan::tiles.columns + tile,
                    transformed + tile * planes * width, 1, plan::input_distance, pixel_row);
            blocked<Filters, plan::block_filters>([&](auto filters, std::size_t first_filter) {
                const std::size_t piece = first_piece + first_filter / plan::block_filters;
                if (piece < begin || piece >= end)
                    return;
                for (std::size_t tile = 0; tile < tiles; ++tile)
                    transform_gradient_tile<plan::ahead, Outputs>(
                        gradient + first_filter * plane * width, filters,
                        first_row * plan::tiles.columns + tile, transformed_gradient + tile * filters * width,
                        plan::gradient_distance);
                for (std::size_t e = 0; e < plan::elements; ++e)
                    add_element<filters, vectors>(
                        transformed + e * plan::input_distance,
                        transformed_gradient + e * plan::gradient_distance, tiles,
                        totals + plan::totals_before(first_vector, first_filter, vectors) +
                            e * filters * vectors * width);
            });
        });
    });
}

/// gradients[filter][channel][row][column] = Gᵀ t G of the totals.
template <sliding_window W, std::size_t Filters, extent Outputs, class T>
[[gnu::flatten]] void finish_tiled_gradient(const double* totals, T* gradients) {
    using plan = tiled_gradient_plan<W, Filters, Outputs, T>;
    constexpr extent side = plan::tiles.side;
    constexpr std::size_t kernel = W.kernel.rows, width = lanes<double>;
    const auto finish = [&](const double* from, std::size_t distance, T* to) {
        std::array<std::array<vector<double>, side.columns>, kernel> half;
#pragma GCC unroll 64
        for (std::size_t x = 0; x < side.columns; ++x) {
            std::array<vector<double>, side.rows> column;
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side.rows; ++y)
                column[y] = load(from + (y * side.columns + x) * distance);
            const std::array<vector<double>, kernel> line = detail::tile_weight_line<kernel>(column);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < kernel; ++y)
                half[y][x] = line[y];
        }
        alignas(alignment) std::array<std::array<double, width>, kernel * kernel> taps;
#pragma GCC unroll 64
        for (std::size_t y = 0; y < kernel; ++y) {
            const std::array<vector<double>, kernel> line = detail::tile_weight_line<kernel>(half[y]);
#pragma GCC unroll 64
            for (std::size_t x = 0; x < kernel; ++x)
                store(taps[y * kernel + x].data(), line[x]);
        }
        for (std::size_t lane = 0; lane < width; ++lane)
            for (std::size_t tap = 0; tap < kernel * kernel; ++tap)
                to[lane * kernel * kernel + tap] = static_cast<T>(taps[tap][lane]);
    };
    blocked<plan::vectors, plan::block_vectors>([&](auto vectors, std::size_t first_vector) {
        constexpr std::size_t channels = vectors * lanes<T>;
        blocked<Filters, plan::block_filters>([&](auto filters, std::size_t first_filter) {
            const double* const from = totals + plan::totals_before(first_vector, first_filter, vectors);
            for (std::size_t f = 0; f < filters; ++f)
                for (std::size_t c = 0; c < channels; c += width)
                    finish(from + f * channels + c, filters * channels,
                           gradients + ((first_filter + f) * plan::channels + first_vector * lanes<T> + c) *
                                           kernel * kernel);
        });
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
