#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/batch/winograd/tile_grid.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// The transforms of input tiles and of tiles of the output gradient. A plane is a channel of a lane block or,
// in a transposed map, some channels of one sample.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// How the planes of a map lie in memory.
struct plane_layout {
    std::size_t planes; ///< number of planes
    std::size_t plane;  ///< elements from one plane to the next
    std::size_t pixel;  ///< elements from one pixel to the next
};

/// The pixels of a tile, some of which may lie outside the map.
template <extent2d Side>
struct tile_pixels {
    std::ptrdiff_t top, left;                                   ///< row and column of the first pixel
    std::size_t first_row, last_row, first_column, last_column; ///< the part of the tile inside the map

    static constexpr tile_pixels at(std::ptrdiff_t top, std::ptrdiff_t left, std::size_t rows,
                                    std::size_t columns) {
        const auto first = [](std::ptrdiff_t before) {
            return static_cast<std::size_t>(std::max<std::ptrdiff_t>(-before, 0));
        };
        const auto last = [](std::ptrdiff_t before, std::size_t side, std::size_t size) {
            return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
                static_cast<std::ptrdiff_t>(size) - before, 0, static_cast<std::ptrdiff_t>(side)));
        };
        return {top,         left,
                first(top),  last(top, Side.rows, rows),
                first(left), last(left, Side.columns, columns)};
    }
    [[nodiscard]] constexpr bool inside() const {
        return first_row == 0 && last_row == Side.rows && first_column == 0 && last_column == Side.columns;
    }
};

/// Calls body(plane, from, row distance, pixel distance) for each plane, where `from` is the first pixel of
/// the tile; pixels outside the map are zeros. `columns` are the columns of the map.
template <extent2d Side, class T, class Body>
[[gnu::always_inline]] inline void for_each_plane(const T* map, plane_layout layout, std::size_t columns,
                                                  const tile_pixels<Side>& pixels, Body&& body) {
    constexpr std::size_t width = lanes<T>;
    const std::ptrdiff_t corner = (pixels.top * static_cast<std::ptrdiff_t>(columns) + pixels.left) *
                                  static_cast<std::ptrdiff_t>(layout.pixel);
    const std::size_t row_distance = columns * layout.pixel;
    const bool inside = pixels.inside();
    alignas(vector_alignment) std::array<T, Side.area() * width> padded;
    if (!inside)
        padded.fill(T{});
    for (std::size_t plane = 0; plane < layout.planes; ++plane) {
        const T* from = map + static_cast<std::ptrdiff_t>(plane * layout.plane) + corner;
        if (!inside) {
            for (std::size_t y = pixels.first_row; y < pixels.last_row; ++y) {
                // Unrolled: GCC would call memcpy for so few elements.
                constexpr std::size_t side_columns = Side.columns;
#pragma GCC unroll 8
                for (std::size_t x = 0; x < side_columns; ++x)
                    if (x >= pixels.first_column && x < pixels.last_column)
                        store(padded.data() + (y * side_columns + x) * width,
                              load(from + y * row_distance + x * layout.pixel));
            }
            from = padded.data();
        }
        body(plane, from, inside ? row_distance : Side.columns * width, inside ? layout.pixel : width);
    }
}

/// Transforms one input tile of each plane, Bᵀ d B: element e of plane p goes to to[e · element_distance + p
/// · lanes · step]. `input` begins with row `first_row`.
template <batch_convolution C, extent2d Outputs, class T>
[[gnu::flatten, gnu::noinline]] void
transform_input_tile(const T* input, plane_layout layout, std::size_t tile, T* to, std::size_t step,
                     std::size_t element_distance, std::size_t first_row = 0) {
    constexpr tile_grid tiles = tile_grid::of(C, Outputs);
    constexpr extent2d side = tiles.side;
    constexpr std::size_t side_columns = side.columns; // not in the lambda: GCC 12 takes it for uninitialised
    const auto top = static_cast<std::ptrdiff_t>(tile / tiles.columns * Outputs.rows) - C.top,
               left = static_cast<std::ptrdiff_t>(tile % tiles.columns * Outputs.columns) - C.left;
    auto pixels = tile_pixels<side>::at(top, left, C.input.rows, C.input.columns);
    pixels.top -= static_cast<std::ptrdiff_t>(first_row);
    for_each_plane(
        input, layout, C.input.columns, pixels,
        [&](std::size_t plane, const T* from, std::size_t row,
            std::size_t pixel) __attribute__((always_inline)) {
            T* const place = to + plane * lanes<T> * step;
            detail::transform_tile_input<vector<T>, side.rows, side.columns>(
                [&](std::size_t y, std::size_t x)
                    __attribute__((always_inline)) { return load(from + y * row + x * pixel); },
                [&](std::size_t y, std::size_t x, const vector<T>& element) __attribute__((always_inline)) {
                    store(place + (y * side_columns + x) * element_distance, element);
                });
        });
}

/// Transforms one tile of the output gradient of each plane, A δ Aᵀ: element e of plane p goes to to[e ·
/// element_distance + p · lanes]. `gradient` begins with row `first_row`.
template <batch_convolution C, extent2d Outputs, class T>
[[gnu::flatten, gnu::noinline]] void
transform_gradient_tile(const T* gradient, plane_layout layout, std::size_t tile, T* to,
                        std::size_t element_distance, std::size_t first_row = 0) {
    constexpr tile_grid tiles = tile_grid::of(C, Outputs);
    constexpr extent2d side = tiles.side;
    constexpr std::size_t width = lanes<T>;
    const auto top = static_cast<std::ptrdiff_t>(tile / tiles.columns * Outputs.rows),
               left = static_cast<std::ptrdiff_t>(tile % tiles.columns * Outputs.columns);
    auto pixels = tile_pixels<Outputs>::at(top, left, C.output.rows, C.output.columns);
    pixels.top -= static_cast<std::ptrdiff_t>(first_row);
    for_each_plane(
        gradient, layout, C.output.columns, pixels,
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

}}} // namespace tactnet::kernels
