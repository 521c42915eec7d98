#pragma once

#include <tactnet/kernels/batch/tiles/gradient_plan.hpp>
#include <tactnet/kernels/batch/tiles/tile_transforms.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// The gradient of a convolution with respect to its weights by tiles, of one group after the other. Sums stay
// in the transformed domain until the end of a batch. gradient_plan.hpp says what is computed and how it is
// cut.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// One element, one block, one band: totals[number][lane] += Σ over tiles and samples.
template <std::size_t Numbers, std::size_t Vectors, class T>
[[gnu::always_inline]] inline void add_element(const T* values, const T* numbers, std::size_t tiles,
                                               double* totals) {
    constexpr std::size_t width = lanes<T>;
    std::array<std::array<vector<T>, Vectors>, Numbers> sums;
#pragma GCC unroll 64
    for (std::size_t n = 0; n < Numbers; ++n) {
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            sums[n][v] = vector<T>(T{});
    }
    for (std::size_t tile = 0; tile < tiles; ++tile, numbers += Numbers * width)
        for (std::size_t sample = 0; sample < width; ++sample, values += Vectors * width) {
            std::array<vector<T>, Vectors> x;
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                x[v] = load(values + v * width);
#pragma GCC unroll 64
            for (std::size_t n = 0; n < Numbers; ++n) {
                const vector<T> number(numbers[n * width + sample]);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < Vectors; ++v)
                    sums[n][v] = multiply_add(number, x[v], sums[n][v]);
            }
        }
#pragma GCC unroll 64
    for (std::size_t n = 0; n < Numbers; ++n) {
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            add_each_lane<T>(totals + (n * Vectors + v) * width, sums[n][v]);
    }
}

/// One tile of the input, or of the outputs' gradient, of every plane.
template <batch_convolution C, extent2d Outputs, bool OfGradient, class T>
[[gnu::always_inline]] inline void transform_factor(const T* map, plane_layout layout, std::size_t tile,
                                                    T* to, std::size_t element_distance,
                                                    std::size_t first_row = 0) {
    if constexpr (OfGradient)
        transform_gradient_tile<C, Outputs>(map, layout, tile, to, element_distance, first_row);
    else
        transform_input_tile<C, Outputs>(map, layout, tile, to, 1, element_distance, first_row);
}

/// totals += the gradient of one group, for the pieces [begin, end).
template <sliding_window W, std::size_t Filters, extent2d Outputs, class T>
[[gnu::flatten]] void add_tiled_gradient(const T* input, const T* gradient, double* totals, T* scratch,
                                         std::size_t begin, std::size_t end) {
    using plan = tiled_gradient_plan<W, Filters, Outputs, T>;
    constexpr bool by_filters = plan::block.filters_in_lanes;
    constexpr std::size_t width = lanes<T>;
    constexpr std::size_t map_rows = plan::turned_map.rows, map_columns = plan::turned_map.columns;
    const T *const turned_from = by_filters ? gradient : input, *const numbers_from =
                                                                    by_filters ? input : gradient;
    constexpr std::size_t plane = plan::turned_map.area() * width,
                          number_plane = (by_filters ? plan::ahead.input : plan::ahead.output).area() * width;
    T* const values = scratch + plan::turned;
    T* const numbers = values + plan::elements * plan::vector_distance;
    blocked<plan::vectors, plan::block.vectors>([&](auto vectors, std::size_t first_vector) {
        const std::size_t first_piece = first_vector / plan::block.vectors * plan::number_blocks;
        if (begin == end || first_piece + plan::number_blocks <= begin || first_piece >= end)
            return;
        blocked<plan::tiles.rows, plan::band_rows>([&](auto rows, std::size_t first_row) {
            constexpr std::size_t tiles = rows * plan::tiles.columns, planes = width * vectors;
            const std::size_t first_tile = first_row * plan::tiles.columns;
            // Rows of the map that these tiles read, turned.
            const std::ptrdiff_t top =
                static_cast<std::ptrdiff_t>(first_row * Outputs.rows) - (by_filters ? 0 : plan::ahead.top);
            constexpr std::size_t reach =
                (rows - 1) * Outputs.rows + (by_filters ? Outputs.rows : plan::tiles.side.rows);
            const auto map_row = static_cast<std::size_t>(std::max<std::ptrdiff_t>(top, 0));
            const std::size_t end_row =
                std::min(static_cast<std::size_t>(top + static_cast<std::ptrdiff_t>(reach)), map_rows);
            for (std::size_t pixel = map_row * map_columns; pixel < end_row * map_columns; ++pixel)
                for (std::size_t v = 0; v < vectors; ++v)
                    transpose(turned_from + (first_vector + v) * width * plane + pixel * width, plane,
                              scratch + ((pixel - map_row * map_columns) * planes + v) * width,
                              vectors * width);
            for (std::size_t tile = 0; tile < tiles; ++tile)
                transform_factor<plan::ahead, Outputs, by_filters>(
                    scratch, {planes, width, planes * width}, first_tile + tile,
                    values + tile * planes * width, plan::vector_distance, map_row);
            blocked<plan::numbers, plan::block.numbers>([&](auto count, std::size_t first_number) {
                const std::size_t piece = first_piece + first_number / plan::block.numbers;
                if (piece < begin || piece >= end)
                    return;
                for (std::size_t tile = 0; tile < tiles; ++tile)
                    transform_factor<plan::ahead, Outputs, !by_filters>(
                        numbers_from + first_number * number_plane, {count, number_plane, width},
                        first_tile + tile, numbers + tile * count * width, plan::number_distance);
                double* const to = totals + plan::totals_before(first_vector, first_number, vectors);
                for (std::size_t e = 0; e < plan::elements; ++e)
                    add_element<count, vectors>(values + e * plan::vector_distance,
                                                numbers + e * plan::number_distance, tiles,
                                                to + e * count * vectors * width);
            });
        });
    });
}

/// Gᵀ t G of as many sums as a vector of doubles has lanes; from one element to the next, and from one lane
/// to the next of the gradients [row][column], it is a distance.
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
    alignas(alignment) std::array<std::array<double, width>, Kernel * Kernel> taps;
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

/// gradients[filter][channel][row][column] from the totals.
template <sliding_window W, std::size_t Filters, extent2d Outputs, class T>
[[gnu::flatten]] void finish_tiled_gradient(const double* totals, T* gradients) {
    using plan = tiled_gradient_plan<W, Filters, Outputs, T>;
    constexpr std::size_t taps = W.kernel.area(), of_filter = W.input.channels * taps;
    constexpr std::size_t lane_distance = plan::block.filters_in_lanes ? of_filter : taps,
                          number_distance = plan::block.filters_in_lanes ? taps : of_filter;
    constexpr extent2d side = plan::tiles.side;
    blocked<plan::vectors, plan::block.vectors>([&](auto vectors, std::size_t first_vector) {
        constexpr std::size_t in_block = vectors * lanes<T>;
        blocked<plan::numbers, plan::block.numbers>([&](auto count, std::size_t first_number) {
            const double* const from = totals + plan::totals_before(first_vector, first_number, vectors);
            for (std::size_t n = 0; n < count; ++n)
                for (std::size_t lane = 0; lane < in_block; lane += lanes<double>)
                    finish_tiled_weights<side, W.kernel.rows>(
                        from + n * in_block + lane, count * in_block,
                        gradients + (first_number + n) * number_distance +
                            (first_vector * lanes<T> + lane) * lane_distance,
                        lane_distance);
        });
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
