#pragma once

#include <tactnet/kernels/frame/winograd_tiles.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <array>
#include <cstddef>

// One frame or some through a convolution by tiles. winograd_tiles.hpp says what is computed, how it is cut,
// and packs the kernels.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// transformed[element][tile][channel] = Bᵀ d B of the input tiles [first, last); what lies outside the image
/// is zero. Frames lie `distance` elements apart.
template <frame_convolution C, extent2d Outputs, std::size_t Frames>
[[gnu::flatten, gnu::noinline]] void transform_winograd_input(const float* input, std::size_t distance,
                                                              float* transformed, std::size_t first,
                                                              std::size_t last) {
    using tiles = winograd_tiles<C, Outputs, Frames>;
    using wide = sized_vector<float, tiles::input_width>;
    constexpr std::size_t rows = tiles::side.rows, columns = tiles::side.columns, elements = rows * columns;
    constexpr auto image_rows = static_cast<std::ptrdiff_t>(C.window.input.rows),
                   image_columns = static_cast<std::ptrdiff_t>(C.window.input.columns);
    alignas(alignment) const std::array<float, tiles::input_stride> outside{};
    for (std::size_t tile = first; tile < last; ++tile) {
        const std::size_t frame = Frames > 1 ? tile / tiles::of_frame : 0;
        const std::size_t place = tile - frame * tiles::of_frame;
        const float* const image = input + frame * distance;
        const auto top = static_cast<std::ptrdiff_t>(place / tiles::columns * Outputs.rows) -
                         static_cast<std::ptrdiff_t>(C.window.top);
        const auto left = static_cast<std::ptrdiff_t>(place % tiles::columns * Outputs.columns) -
                          static_cast<std::ptrdiff_t>(C.window.left);
        std::array<const float*, tiles::elements> pixels;
#pragma GCC unroll 64
        for (std::size_t e = 0; e < elements; ++e) {
            const std::ptrdiff_t y = top + static_cast<std::ptrdiff_t>(e / columns),
                                 x = left + static_cast<std::ptrdiff_t>(e % columns);
            const bool inside = y >= 0 && y < image_rows && x >= 0 && x < image_columns;
            pixels[e] = inside ? image + (y * image_columns + x) * static_cast<std::ptrdiff_t>(C.input_stride)
                               : outside.data();
        }
        float* const to = transformed + (tile - first) * tiles::input_stride;
        for (std::size_t channel = 0; channel < tiles::input_stride; channel += tiles::input_width) {
            detail::transform_tile_input<wide, rows, columns>(
                [&](std::size_t y, std::size_t x) __attribute__((always_inline)) {
                    return load_as<wide>(pixels[y * columns + x] + channel);
                },
                [&](std::size_t y, std::size_t x, const wide& element) __attribute__((always_inline)) {
                    store_as(to + (y * columns + x) * tiles::band * tiles::input_stride + channel, element);
                });
        }
    }
}

/// products[tile][filter] of one element and `Tiles` tiles: a matrix product over the channels.
template <frame_convolution C, extent2d Outputs, std::size_t Vectors, std::size_t Tiles>
[[gnu::flatten, gnu::noinline]] void multiply_winograd_tiles(const float* input, const float* weights,
                                                             float* products) {
    using tiles = winograd_tiles<C, Outputs>;
    using wide = sized_vector<float, C.width()>;
    register_block<wide, Tiles, Vectors> sums;
#pragma GCC unroll 64
    for (std::size_t i = 0; i < Tiles * Vectors; ++i)
        sums[i / Vectors][i % Vectors] = wide(0.0f);
    for (std::size_t channel = 0; channel < tiles::channels; ++channel) {
        std::array<wide, Vectors> w;
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            w[v] = load_as<wide>(weights + (channel * Vectors + v) * C.width());
#pragma GCC unroll 64
        for (std::size_t t = 0; t < Tiles; ++t) {
            const wide x(input[t * tiles::input_stride + channel]);
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                sums[t][v] = fused_multiply_add(w[v], x, sums[t][v]);
        }
    }
#pragma GCC unroll 64
    for (std::size_t i = 0; i < Tiles * Vectors; ++i)
        store_as(products + i * C.width(), sums[i / Vectors][i % Vectors]);
}

/// Outputs of the tiles [first, last): Aᵀ m A, bias, the other term of a sum, max pool, ReLU. Frames lie
/// `distance` elements apart.
template <frame_convolution C, extent2d Outputs, std::size_t Frames, std::size_t Vectors>
[[gnu::flatten, gnu::noinline]] void transform_winograd_output(const float* products, const float* bias,
                                                               float* output, std::size_t distance,
                                                               std::size_t first, std::size_t last) {
    using tiles = winograd_tiles<C, Outputs, Frames>;
    using wide = sized_vector<float, C.width()>;
    constexpr std::size_t width = C.width(), rows = tiles::side.rows, columns = tiles::side.columns;
    constexpr std::size_t window = C.pool.area();
    for (std::size_t tile = first; tile < last; ++tile, products += Vectors * width) {
        const std::size_t frame = Frames > 1 ? tile / tiles::of_frame : 0;
        const std::size_t place = tile - frame * tiles::of_frame;
        const std::size_t top = place / tiles::columns * Outputs.rows,
                          left = place % tiles::columns * Outputs.columns;
        // Of the image; the tile may reach beyond its end.
        const std::size_t rows_left = C.rows() - top, columns_left = C.columns() - left;
        float* const to_tile =
            output + frame * distance +
            (top / C.pool.rows * C.output_columns() + left / C.pool.columns) * C.output_stride();
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v) {
            std::array<std::array<wide, columns>, Outputs.rows> half;
#pragma GCC unroll 64
            for (std::size_t x = 0; x < columns; ++x) {
                std::array<wide, rows> column;
#pragma GCC unroll 64
                for (std::size_t y = 0; y < rows; ++y)
                    column[y] =
                        load_as<wide>(products + ((y * columns + x) * tiles::band * Vectors + v) * width);
                const std::array<wide, Outputs.rows> line = detail::tile_output_line<Outputs.rows>(column);
#pragma GCC unroll 64
                for (std::size_t y = 0; y < Outputs.rows; ++y)
                    half[y][x] = line[y];
            }
            const wide start = load_as<wide>(bias + v * width);
            // A window of the pool at a time; its first output decides whether there is one.
#pragma GCC unroll 64
            for (std::size_t row = 0; row < Outputs.rows; row += C.pool.rows) {
                std::array<std::array<wide, Outputs.columns>, C.pool.rows> y;
#pragma GCC unroll 64
                for (std::size_t r = 0; r < C.pool.rows; ++r)
                    y[r] = detail::tile_output_line<Outputs.columns>(half[row + r]);
                if (row > 0 && row >= rows_left)
                    continue;
#pragma GCC unroll 64
                for (std::size_t column = 0; column < Outputs.columns; column += C.pool.columns) {
                    if (column > 0 && column >= columns_left)
                        continue;
                    wide value = y[0][column];
#pragma GCC unroll 64
                    for (std::size_t i = 1; i < window; ++i) {
                        const std::size_t down = i / C.pool.columns, right = i % C.pool.columns;
                        if (row + down < rows_left && column + right < columns_left)
                            value = maximum_or_second(y[down][column + right], value);
                    }
                    value = value + start;
                    float* const to = to_tile +
                                      (row / C.pool.rows * C.output_columns() + column / C.pool.columns) *
                                          C.output_stride() +
                                      v * width;
                    if constexpr (C.adds)
                        value = value + load_as<wide>(to);
                    if constexpr (C.rectified)
                        value = maximum_or_second(wide(0.0f), value);
                    store_as(to, value);
                }
            }
        }
    }
}

/// output = the fused step for so many frames, as convolve_frame for each; inputs and outputs of frames lie
/// so many elements apart. `scratch` holds winograd_tiles<C, Outputs, Frames>::scratch elements. The bits of
/// a frame do not depend on those beside it.
template <frame_convolution C, extent2d Outputs = best_tile(C), std::size_t Frames = 1>
void convolve_frames_by_tiles(const float* input, std::size_t input_distance, const float* weights,
                              const float* bias, float* output, std::size_t output_distance, float* scratch) {
    static_assert(!C.adds || C.pool == extent2d(1), "convolve_frames_by_tiles: a sum is not pooled");
    static_assert(C.groups == 1 && C.fits_map(), "convolve_frames_by_tiles: the output does not fit its map");
    using tiles = winograd_tiles<C, Outputs, Frames>;
    float* const products = scratch + tiles::transformed_input;
    blocked<tiles::count, tiles::band>([&](auto band, std::size_t first_tile) {
        transform_winograd_input<C, Outputs, Frames>(input, input_distance, scratch, first_tile,
                                                     first_tile + band);
        blocked<C.vectors(), tiles::block_vectors>([&](auto vectors, std::size_t first_vector) {
            const std::size_t first = first_vector * C.width();
            const float* w = weights + first * tiles::elements * tiles::channels;
            for (std::size_t e = 0; e < tiles::elements; ++e)
                blocked<band, tiles::block>([&](auto count, std::size_t tile) {
                    multiply_winograd_tiles<C, Outputs, vectors, count>(
                        scratch + (e * tiles::band + tile) * tiles::input_stride,
                        w + e * tiles::channels * vectors * C.width(),
                        products + (e * tiles::band + tile) * vectors * C.width());
                });
            transform_winograd_output<C, Outputs, Frames, vectors>(
                products, bias + first, output + first, output_distance, first_tile, first_tile + band);
        });
    });
}
/// The same for one frame.
template <frame_convolution C, extent2d Outputs = best_tile(C)>
void convolve_frame_by_tiles(const float* input, const float* weights, const float* bias, float* output,
                             float* scratch) {
    convolve_frames_by_tiles<C, Outputs>(input, 0, weights, bias, output, 0, scratch);
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
