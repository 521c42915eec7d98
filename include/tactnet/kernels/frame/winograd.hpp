#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame/winograd_tiles.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// The Winograd convolution of one frame or several. winograd_tiles.hpp describes the tiles.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// transformed[element][tile][channel] = Bᵀ d B of the input tiles [first, last); pixels outside the image
/// are zero. Frames lie `distance` elements apart.
template <frame_convolution C, extent2d Outputs, std::size_t Frames>
[[gnu::flatten, gnu::noinline]] void transform_winograd_input(const float* input, std::size_t distance,
                                                              float* transformed, std::size_t first,
                                                              std::size_t last) {
    using tiles = winograd_tiles<C, Outputs, Frames>;
    using wide = sized_vector<float, tiles::input_width>;
    constexpr std::size_t rows = tiles::side.rows, columns = tiles::side.columns, elements = rows * columns;
    constexpr auto image_rows = static_cast<std::ptrdiff_t>(C.window.input.rows),
                   image_columns = static_cast<std::ptrdiff_t>(C.window.input.columns);
    alignas(vector_alignment) const std::array<float, tiles::input_stride> outside{};
    for (std::size_t tile = first; tile < last; ++tile) {
        const std::size_t frame = Frames > 1 ? tile / tiles::tiles_per_frame : 0;
        const std::size_t place = tile - frame * tiles::tiles_per_frame;
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
                    store_as(to + (y * columns + x) * tiles::input_distance + channel, element);
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
        prefetch_weights<Vectors * C.width() * sizeof(float), tiles::weight_bytes, Tiles>(
            weights + (tiles::channels + channel) * Vectors * C.width()); // of the next element
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

/// Outputs of the tiles [first, last): Aᵀ m A, bias, the other term of a sum, max pool, activation function.
/// Frames lie `distance` elements apart.
template <frame_convolution C, extent2d Outputs, std::size_t Frames, std::size_t Vectors>
[[gnu::flatten, gnu::noinline]] void transform_winograd_output(const float* products, const float* bias,
                                                               float* output, std::size_t distance,
                                                               std::size_t first, std::size_t last) {
    using tiles = winograd_tiles<C, Outputs, Frames>;
    using wide = sized_vector<float, C.width()>;
    constexpr std::size_t width = C.width(), rows = tiles::side.rows, columns = tiles::side.columns;
    constexpr std::size_t window = C.pool.area();
    for (std::size_t tile = first; tile < last; ++tile, products += Vectors * width) {
        const std::size_t frame = Frames > 1 ? tile / tiles::tiles_per_frame : 0;
        const std::size_t place = tile - frame * tiles::tiles_per_frame;
        const std::size_t top = place / tiles::columns * Outputs.rows,
                          left = place % tiles::columns * Outputs.columns;
        // The tile may extend past the end of the image.
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
                        load_as<wide>(products + (y * columns + x) * tiles::product_distance + v * width);
                const std::array<wide, Outputs.rows> line = detail::tile_output_line<Outputs.rows>(column);
#pragma GCC unroll 64
                for (std::size_t y = 0; y < Outputs.rows; ++y)
                    half[y][x] = line[y];
            }
            const wide start = load_as<wide>(bias + v * width);
            // One window of the pool at a time. It exists if its first output is in the image.
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
                    if constexpr (C.accumulates)
                        value = value + load_as<wide>(to);
                    store_as(to, activated<C>(value));
                }
            }
        }
    }
}

/// Winograd convolution in tiles of `Outputs`. The tiles of several frames may share one list: with few
/// tiles, a layer waits for its weights, and more tiles amortise the load. The bits of a frame do not depend
/// on the others.
template <frame_convolution C, extent2d Outputs = best_tile(C)>
struct winograd_method : frame_method {
    static constexpr const char* name = "Winograd";
    static constexpr bool applicable = C.groups == 1 && C.fits_map() && Outputs != extent2d(0);
    static constexpr extent2d tile = Outputs;
    /// The least cost for which tile_costs::to_replace(another cost) is larger than the cost of the tiles.
    static constexpr std::uint64_t product_twentieths =
        (cost_by_tiles(C, Outputs) * 21 / 20 + 1) * memory_penalty(C);
    static constexpr std::size_t packed_weights = pad_to_cache_line(
        winograd_tiles<C, Outputs>::elements * C.window.input.channels * C.padded_filters());
    static constexpr std::size_t packed_elements = packed_weights + pad_to_cache_line(C.padded_filters());
    /// One list of tiles only while the transformed numbers stay in the nearest levels: with an eighth of the
    /// second level one list was faster, with more it was slower (Zen 4).
    static constexpr std::size_t frames_together =
        winograd_tiles<C, Outputs, 4>::workspace * sizeof(float) <= l2_cache_bytes / 8 ? 4 : 1;
    /// Enough for one frame, and for each frame of a list of several.
    static constexpr std::size_t workspace_elements = std::max(
        winograd_tiles<C, Outputs>::workspace,
        pad_to_cache_line(ceil_div(winograd_tiles<C, Outputs, frames_together>::workspace, frames_together)));

    /// Kernels as G g Gᵀ in the order of use, into zeros: blocks of vectors of filters, then
    /// [element][channel][filter of the block].
    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* packed) {
        using tiles = winograd_tiles<C, Outputs>;
        constexpr std::size_t kernel = C.window.kernel.rows, channels = tiles::channels;
        constexpr extent2d side = tiles::side;
        std::copy_n(biases, C.filters, packed + packed_weights);
        for (std::size_t first = 0; first < C.padded_filters(); first += tiles::block_stride) {
            const std::size_t count = std::min(tiles::block_stride, C.padded_filters() - first);
            for (std::size_t channel = 0; channel < channels; ++channel)
                for (std::size_t f = 0; f < count && first + f < C.filters; ++f) {
                    std::array<std::array<double, kernel>, side.rows> half{};
                    for (std::size_t column = 0; column < kernel; ++column) {
                        std::array<double, kernel> g{};
                        for (std::size_t row = 0; row < kernel; ++row)
                            g[row] = static_cast<double>(weight(first + f, channel, row, column));
                        const std::array<double, side.rows> line = detail::tile_kernel_line<side.rows>(g);
                        for (std::size_t row = 0; row < side.rows; ++row)
                            half[row][column] = line[row];
                    }
                    std::size_t place = channel * count + f;
                    for (const std::array<double, kernel>& row : half)
                        for (const double element : detail::tile_kernel_line<side.columns>(row)) {
                            packed[place] = static_cast<float>(element);
                            place += channels * count;
                        }
                }
            packed += tiles::elements * channels * count;
        }
    }
    static void run(const float* packed, const float* in, float* out, float* workspace) noexcept {
        run_list<1>(packed, in, 0, out, 0, workspace);
    }
    static void run_frames(const float* packed, const float* in, std::size_t in_distance, float* out,
                           std::size_t out_distance, float* workspace) noexcept {
        run_list<frames_together>(packed, in, in_distance, out, out_distance, workspace);
    }
    /// The tiles of so many frames as one list. Inputs and outputs of frames lie so many elements apart, and
    /// the workspace is that of as many frames.
    template <std::size_t Frames>
    static void run_list(const float* packed, const float* input, std::size_t input_distance, float* output,
                         std::size_t output_distance, float* workspace) noexcept {
        static_assert(!C.accumulates || C.pool == extent2d(1), "winograd_method: a sum is not pooled");
        using tiles = winograd_tiles<C, Outputs, Frames>;
        static_assert((Frames != 1 && Frames != frames_together) ||
                      tiles::workspace <= Frames * workspace_elements);
        const float* const bias = packed + packed_weights;
        float* const products = workspace + tiles::transformed_input;
        blocked<tiles::count, tiles::band>([&](auto band, std::size_t first_tile) {
            transform_winograd_input<C, Outputs, Frames>(input, input_distance, workspace, first_tile,
                                                         first_tile + band);
            blocked<C.vectors(), tiles::block_vectors>([&](auto vectors, std::size_t first_vector) {
                const std::size_t first = first_vector * C.width();
                const float* w = packed + first * tiles::elements * tiles::channels;
                for (std::size_t e = 0; e < tiles::elements; ++e)
                    blocked<band, tiles::block>([&](auto count, std::size_t place) {
                        multiply_winograd_tiles<C, Outputs, vectors, count>(
                            workspace + e * tiles::input_distance + place * tiles::input_stride,
                            w + e * tiles::channels * vectors * C.width(),
                            products + e * tiles::product_distance + place * vectors * C.width());
                    });
                transform_winograd_output<C, Outputs, Frames, vectors>(
                    products, bias + first, output + first, output_distance, first_tile, first_tile + band);
            });
            // The rows of tiles that this band completes.
            const std::size_t end = (first_tile + band) / tiles::columns, high = Outputs.rows / C.pool.rows;
            for (std::size_t row = first_tile / tiles::columns; row < end; ++row) {
                const std::size_t y = row % tiles::rows * high;
                float* const to = output + row / tiles::rows * output_distance;
                activate_outputs<C>(to + y * C.output_columns() * C.output_stride(),
                                    std::min(high, C.output_rows() - y), C.output_columns());
            }
        });
    }
};

}}} // namespace tactnet::kernels
