#pragma once

#include <tactnet/kernels/batch/tiles/tile_transforms.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Convolution of one group of samples by tiles: y = Aᵀ [(G g Gᵀ) ∘ (Bᵀ d B)] A, with d the input tile, g the
// kernel, y the outputs. The products are a matrix product over the channels for each element of a tile, by
// register blocks of output channels × tiles, as taps have (batch/convolution.hpp). The sum over the channels
// runs in their order, whatever the blocking.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// How a convolution of one group is computed by tiles.
template <batch_convolution C, extent2d Outputs, class T>
struct tiled_convolution {
    static_assert(group_tile_possible(C, Outputs), "tiled_convolution: there are no lines for this tile");
    /// Its map, cut.
    static constexpr group_tiles tiles = group_tiles::of(C, Outputs);
    static constexpr std::size_t elements = tiles.elements(); ///< of an input tile
    /// Channels of the input and of the output.
    static constexpr std::size_t channels = C.input.channels, filters = C.output.channels;
    /// Output channels of a register block.
    static constexpr std::size_t block_filters = std::min(block_channels, filters);
    /// Tiles of one.
    static constexpr std::size_t block = std::min(block_outputs, tiles.count());
    /// Tiles from the first transform to the last: what half of the second level holds, but at least a block.
    static constexpr std::size_t band = [] {
        constexpr std::size_t of_a_tile = elements * (channels + block_filters) * lanes<T> * sizeof(T);
        const std::size_t most = std::max(l2_cache_bytes / 2 / of_a_tile / block * block, block);
        return std::min(most, tiles.count());
    }();
    /// From one element of a tile to the next, of transformed inputs and of products.
    static constexpr std::size_t input_distance = odd_lines<T>(band * channels * lanes<T>),
                                 product_distance = odd_lines<T>(band * block_filters * lanes<T>);
    /// Elements that a thread needs.
    static constexpr std::size_t scratch = elements * (input_distance + product_distance);
    /// Elements of the packed kernels (tile_weights.hpp).
    static constexpr std::size_t weights = tile_weights_before<C, T>(elements, filters);

    /// Of a tile of a band: the first of its register block, and how many there are.
    struct place_in_band {
        std::size_t first; ///< tile of the block
        std::size_t count; ///< of its tiles
        /// Of a tile in a band of so many.
        constexpr place_in_band(std::size_t tile, std::size_t of_band)
            : first(tile / block * block), count(std::min(block, of_band - first)) {}
    };
};

/// One element of `Tiles` tiles: products[filter][tile] = Σ over channels of transformed[channel][tile] ·
/// weights[channel][filter].
template <std::size_t Channels, std::size_t Filters, std::size_t Tiles, class T>
[[gnu::always_inline]] inline void multiply_element(const T* transformed, const T* weights, T* products) {
    std::array<std::array<vector<T>, Tiles>, Filters> sums;
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
        for (std::size_t t = 0; t < Tiles; ++t)
            sums[f][t] = vector<T>(T{});
    }
    for (std::size_t channel = 0; channel < Channels; ++channel) {
        std::array<vector<T>, Tiles> x;
#pragma GCC unroll 64
        for (std::size_t t = 0; t < Tiles; ++t)
            x[t] = load(transformed + (channel * Tiles + t) * lanes<T>);
#pragma GCC unroll 64
        for (std::size_t f = 0; f < Filters; ++f) {
            const vector<T> weight(weights[channel * Filters + f]);
#pragma GCC unroll 64
            for (std::size_t t = 0; t < Tiles; ++t)
                sums[f][t] = multiply_add(weight, x[t], sums[f][t]);
        }
    }
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
        for (std::size_t t = 0; t < Tiles; ++t)
            store(products + (f * Tiles + t) * lanes<T>, sums[f][t]);
    }
}

/// Aᵀ m A + bias of one tile of one output channel. So many rows and columns of the map are left.
template <batch_convolution C, extent2d Outputs, class T>
[[gnu::always_inline]] inline void transform_output_tile(const T* products, std::size_t element_distance,
                                                         T bias, T* output, std::size_t rows_left,
                                                         std::size_t columns_left) {
    constexpr extent2d side = group_tiles::of(C, Outputs).side;
    std::array<std::array<vector<T>, side.columns>, Outputs.rows> half;
#pragma GCC unroll 64
    for (std::size_t x = 0; x < side.columns; ++x) {
        std::array<vector<T>, side.rows> column;
#pragma GCC unroll 64
        for (std::size_t y = 0; y < side.rows; ++y)
            column[y] = load(products + (y * side.columns + x) * element_distance);
        const std::array<vector<T>, Outputs.rows> sums = detail::tile_output_line<Outputs.rows>(column);
#pragma GCC unroll 64
        for (std::size_t y = 0; y < Outputs.rows; ++y)
            half[y][x] = sums[y];
    }
    const vector<T> start(bias);
#pragma GCC unroll 64
    for (std::size_t y = 0; y < Outputs.rows; ++y) {
        if (y > 0 && y >= rows_left)
            continue;
        const std::array<vector<T>, Outputs.columns> line =
            detail::tile_output_line<Outputs.columns>(half[y]);
#pragma GCC unroll 64
        for (std::size_t x = 0; x < Outputs.columns; ++x)
            if (x == 0 || x < columns_left)
                store(output + (y * C.output.columns + x) * lanes<T>, line[x] + start);
    }
}

/// The outputs of the tiles [first_tile, last_tile), one band, of `Filters` output channels.
template <batch_convolution C, extent2d Outputs, std::size_t Filters, class T>
[[gnu::flatten, gnu::noinline]] void transform_output_band(const T* products, const T* bias, T* output,
                                                           std::size_t first_tile, std::size_t last_tile) {
    using plan = tiled_convolution<C, Outputs, T>;
    for (std::size_t tile = first_tile; tile < last_tile; ++tile) {
        const std::size_t index = tile - first_tile;
        const typename plan::place_in_band block(index, last_tile - first_tile);
        const std::size_t y = tile / plan::tiles.columns * Outputs.rows,
                          x = tile % plan::tiles.columns * Outputs.columns;
        for (std::size_t f = 0; f < Filters; ++f)
            transform_output_tile<C, Outputs>(
                products + (block.first * Filters + f * block.count + index - block.first) * lanes<T>,
                plan::product_distance, bias ? bias[f] : T{},
                output + (f * C.output.area() + y * C.output.columns + x) * lanes<T>, C.output.rows - y,
                C.output.columns - x);
    }
}

/// output = bias + convolution of input and weights, for one group. `bias` may be null; `scratch` holds
/// tiled_convolution::scratch elements.
template <batch_convolution C, extent2d Outputs, class T>
[[gnu::flatten]] void correlate_by_tiles(const T* input, const T* packed_weights, const T* bias, T* output,
                                         T* scratch) {
    using plan = tiled_convolution<C, Outputs, T>;
    constexpr std::size_t width = lanes<T>;
    constexpr plane_layout channels{plan::channels, C.input.area() * width, width};
    T* const products = scratch + plan::elements * plan::input_distance;
    blocked<plan::tiles.count(), plan::band>([&](auto band, std::size_t first_tile) {
        for (std::size_t tile = 0; tile < band; ++tile) {
            const typename plan::place_in_band block(tile, band);
            transform_input_tile<C, Outputs>(input, channels, first_tile + tile,
                                             scratch +
                                                 (block.first * plan::channels + tile - block.first) * width,
                                             block.count, plan::input_distance);
        }
        blocked<plan::filters, plan::block_filters>([&](auto filters, std::size_t first_filter) {
            const T* const weights = packed_weights + tile_weights_before<C, T>(plan::elements, first_filter);
            for (std::size_t e = 0; e < plan::elements; ++e)
                blocked<band, plan::block>([&](auto count, std::size_t tile) {
                    multiply_element<plan::channels, filters, count>(
                        scratch + e * plan::input_distance + tile * plan::channels * width,
                        weights + e * odd_lines<T>(plan::channels * filters),
                        products + e * plan::product_distance + tile * filters * width);
                });
            transform_output_band<C, Outputs, filters>(products, bias ? bias + first_filter : nullptr,
                                                       output + first_filter * C.output.area() * width,
                                                       first_tile, first_tile + band);
        });
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
