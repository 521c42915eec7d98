#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/channel_gradient.hpp>
#include <tactnet/kernels/batch/direct_gradient.hpp>
#include <tactnet/kernels/batch/winograd/tile_grid.hpp>
#include <tactnet/kernels/batch/winograd/transforms.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/kernels/simd/transpose.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// The weight gradient by tiles: Gᵀ [Σ (Bᵀ d B) ∘ (A δ Aᵀ)] G, with the input tile d, the output gradient δ
// and the sum over all tiles of all samples. It is the bilinear form of Winograd convolution with other
// arguments. A vector holds channels, or filters, of one sample, so that each lane is a sum of its own; the
// other factor is broadcast. The sums stay in the transformed domain until the end of a batch.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Accumulates one element of one block over a band: totals[number][lane] += Σ over tiles and samples.
template <std::size_t Numbers, std::size_t Vectors, class T>
[[gnu::always_inline]] inline void accumulate_element(const T* values, const T* numbers, std::size_t tiles,
                                                      double* totals) {
    constexpr std::size_t width = lanes<T>;
    std::array<std::array<vector<T>, Vectors>, Numbers> sums;
#pragma GCC unroll 64
    for (std::size_t n = 0; n < Numbers; ++n)
        sums[n].fill(vector<T>(T{}));
    for (std::size_t tile = 0; tile < tiles; ++tile)
        add_sample_products(sums, values + tile * width * Vectors * width, numbers + tile * Numbers * width,
                            width);
#pragma GCC unroll 64
    for (std::size_t n = 0; n < Numbers; ++n) {
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            add_each_lane<T>(totals + (n * Vectors + v) * width, sums[n][v]);
    }
}

/// Transforms the sums of one vector of doubles back to weights, Gᵀ t G. `distance` is from one element to
/// the next, `lane_distance` from one lane's gradients [row][column] to the next.
template <extent2d Side, std::size_t Kernel, class T>
[[gnu::always_inline]] inline void finish_tiled_weights(const double* totals, std::size_t distance,
                                                        T* gradients, std::size_t lane_distance) {
    constexpr std::size_t width = lanes<double>;
    std::array<std::array<vector<double>, Side.columns>, Kernel> half;
#pragma GCC unroll 64
    for (std::size_t x = 0; x < Side.columns; ++x) {
        std::array<vector<double>, Side.rows> column;
#pragma GCC unroll 64
        for (std::size_t y = 0; y < Side.rows; ++y)
            column[y] = load(totals + (y * Side.columns + x) * distance);
        const std::array<vector<double>, Kernel> line = detail::tile_weight_line<Kernel>(column);
#pragma GCC unroll 64
        for (std::size_t y = 0; y < Kernel; ++y)
            half[y][x] = line[y];
    }
    alignas(vector_alignment) std::array<std::array<double, width>, Kernel * Kernel> taps;
#pragma GCC unroll 64
    for (std::size_t y = 0; y < Kernel; ++y) {
        const std::array<vector<double>, Kernel> line = detail::tile_weight_line<Kernel>(half[y]);
#pragma GCC unroll 64
        for (std::size_t x = 0; x < Kernel; ++x)
            store(taps[y * Kernel + x].data(), line[x]);
    }
    for (std::size_t lane = 0; lane < width; ++lane)
        for (std::size_t tap = 0; tap < Kernel * Kernel; ++tap)
            gradients[lane * lane_distance + tap] = static_cast<T>(taps[tap][lane]);
}

/// The cheapest tile for a weight gradient, or 0 if the gradient by taps is cheaper.
template <batch_convolution C, class T>
[[nodiscard]] constexpr extent2d best_gradient_tile() {
    if constexpr (winograd_possible(C, 2))
        return cheapest_tile(C, tap_gradient<C, T>::half_products, winograd_gradient_possible<T>,
                             winograd_gradient_cost<T>);
    else
        return 0;
}

/// The weight gradient by the cheapest tiles.
template <batch_convolution C, class T, extent2d Outputs = best_gradient_tile<C, T>()>
struct winograd_gradient {
    static constexpr const char* name = "winograd";
    static constexpr extent2d tile = Outputs; ///< outputs of a tile
    static constexpr bool applicable = tile != extent2d(0) && winograd_gradient_possible<T>(C, tile);
    static constexpr std::size_t half_products = winograd_gradient_cost<T>(C, tile);

    static constexpr tile_grid tiles = tile_grid::of(C, tile);
    static constexpr std::size_t elements = tiles.elements(); ///< of an input tile
    static constexpr auto block = gradient_block<T>::of(C);
    static constexpr std::size_t vectors = block.in_lanes / lanes<T>, numbers = block.others;
    static constexpr std::size_t number_blocks = ceil_div(numbers, block.numbers);
    /// Pieces of work write different sums: they may run on different threads.
    static constexpr std::size_t pieces = block.vector_blocks() * number_blocks;

    /// Rows of tiles in a band, and tiles.
    static constexpr std::size_t band_rows = tile_rows_of_band<T>(C, tile),
                                 band_tiles = band_rows * tiles.columns;
    /// The map whose planes go to the lanes, and the rows of it that a band reads.
    static constexpr shape transposed_map = block.filters_in_lanes ? C.output : C.input;
    static constexpr std::size_t transposed_rows =
        std::min((band_rows - 1) * tile.rows + (block.filters_in_lanes ? tile.rows : tiles.side.rows),
                 transposed_map.rows);
    static constexpr std::size_t planes = lanes<T> * block.vectors; ///< vectors of a pixel
    static constexpr std::size_t transposed_elements =
        transposed_rows * transposed_map.columns * planes * lanes<T>;
    /// From one element of a tile to the next, of transformed vectors and numbers.
    static constexpr std::size_t vector_distance = odd_lines<T>(band_tiles * planes * lanes<T>),
                                 number_distance = odd_lines<T>(band_tiles * block.numbers * lanes<T>);
    static constexpr std::size_t workspace_elements =
        transposed_elements + elements * (vector_distance + number_distance);
    /// Sums in the order of use: blocks of vectors, blocks of numbers, each [element][number][lane].
    static constexpr std::size_t totals = elements * vectors * lanes<T> * numbers;

    /// sums += the gradient of one lane block, for the pieces [begin, end).
    [[gnu::flatten]] static void add(const T* input, const T* gradient, double* sums, T* workspace,
                                     std::size_t begin, std::size_t end) {
        constexpr bool by_filters = block.filters_in_lanes;
        constexpr std::size_t width = lanes<T>, map_rows = transposed_map.rows,
                              map_columns = transposed_map.columns;
        const T *const transposed_from = by_filters ? gradient : input, *const numbers_from =
                                                                            by_filters ? input : gradient;
        constexpr std::size_t plane = transposed_map.area() * width,
                              number_plane = (by_filters ? C.input : C.output).area() * width;
        T* const to_vectors = workspace + transposed_elements;
        T* const to_numbers = to_vectors + elements * vector_distance;
        blocked<vectors, block.vectors>([&](auto count, std::size_t first_vector) {
            const std::size_t first_piece = first_vector / block.vectors * number_blocks;
            if (begin == end || first_piece + number_blocks <= begin || first_piece >= end)
                return;
            blocked<tiles.rows, band_rows>([&](auto rows, std::size_t first_row) {
                constexpr std::size_t band = rows * tiles.columns, planes_here = width * count;
                const std::size_t first_tile = first_row * tiles.columns;
                // Transposes the rows of the map that these tiles read.
                const std::ptrdiff_t top =
                    static_cast<std::ptrdiff_t>(first_row * tile.rows) - (by_filters ? 0 : C.top);
                constexpr std::size_t read_rows =
                    (rows - 1) * tile.rows + (by_filters ? tile.rows : tiles.side.rows);
                const auto map_row = static_cast<std::size_t>(std::max<std::ptrdiff_t>(top, 0));
                const std::size_t end_row = std::min(
                    static_cast<std::size_t>(top + static_cast<std::ptrdiff_t>(read_rows)), map_rows);
                for (std::size_t pixel = map_row * map_columns; pixel < end_row * map_columns; ++pixel)
                    for (std::size_t v = 0; v < count; ++v)
                        transpose(transposed_from + (first_vector + v) * width * plane + pixel * width, plane,
                                  workspace + ((pixel - map_row * map_columns) * planes_here + v) * width,
                                  count * width);
                for (std::size_t i = 0; i < band; ++i)
                    transform<by_filters>(workspace, {planes_here, width, planes_here * width},
                                          first_tile + i, to_vectors + i * planes_here * width,
                                          vector_distance, map_row);
                blocked<numbers, block.numbers>([&](auto number_count, std::size_t first_number) {
                    const std::size_t piece = first_piece + first_number / block.numbers;
                    if (piece < begin || piece >= end)
                        return;
                    for (std::size_t i = 0; i < band; ++i)
                        transform<!by_filters>(numbers_from + first_number * number_plane,
                                               {number_count, number_plane, width}, first_tile + i,
                                               to_numbers + i * number_count * width, number_distance);
                    double* const to = sums + totals_before(first_vector, first_number, count);
                    for (std::size_t e = 0; e < elements; ++e)
                        accumulate_element<number_count, count>(to_vectors + e * vector_distance,
                                                                to_numbers + e * number_distance, band,
                                                                to + e * number_count * count * width);
                });
            });
        });
    }

    /// gradients[filter][channel][row][column] from the sums.
    [[gnu::flatten]] static void finish(const double* sums, T* gradients) {
        constexpr std::size_t taps = C.kernel.area(), of_filter = C.input.channels * taps;
        constexpr std::size_t lane_distance = block.filters_in_lanes ? of_filter : taps,
                              number_stride = block.filters_in_lanes ? taps : of_filter;
        blocked<vectors, block.vectors>([&](auto count, std::size_t first_vector) {
            constexpr std::size_t in_block = count * lanes<T>;
            blocked<numbers, block.numbers>([&](auto number_count, std::size_t first_number) {
                const double* const from = sums + totals_before(first_vector, first_number, count);
                for (std::size_t n = 0; n < number_count; ++n)
                    for (std::size_t lane = 0; lane < in_block; lane += lanes<double>)
                        finish_tiled_weights<tiles.side, C.kernel.rows>(
                            from + n * in_block + lane, number_count * in_block,
                            gradients + (first_number + n) * number_stride +
                                (first_vector * lanes<T> + lane) * lane_distance,
                            lane_distance);
            });
        });
    }

private:
    static constexpr std::size_t totals_before(std::size_t first_vector, std::size_t first_number,
                                               std::size_t vectors_of_block) {
        return elements * lanes<T> * (first_vector * numbers + first_number * vectors_of_block);
    }
    /// Transforms one tile of the input, or of the output gradient, of each plane.
    template <bool OfGradient>
    [[gnu::always_inline]] static void transform(const T* map, plane_layout layout, std::size_t index, T* to,
                                                 std::size_t distance, std::size_t first_row = 0) {
        if constexpr (OfGradient)
            transform_gradient_tile<C, tile>(map, layout, index, to, distance, first_row);
        else
            transform_input_tile<C, tile>(map, layout, index, to, 1, distance, first_row);
    }
};

}}} // namespace tactnet::kernels
