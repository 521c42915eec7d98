#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/winograd/transforms.hpp>
#include <tactnet/kernels/caches.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

// Winograd convolution of one lane block: y = Aᵀ [(G g Gᵀ) ∘ (Bᵀ d B)] A, with the input tile d, the kernel g
// and the outputs y. For each element of a tile the products are a matrix product over the channels, in
// register blocks of output channels × tiles as in direct_convolution.hpp. The sum over the channels runs in
// their order, whatever the blocking.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Converts and stores the first `count` lanes.
template <class T>
inline void put_lanes(T* to, const vector<double>& values, std::size_t count) {
    if constexpr (std::is_same_v<T, float>)
        if (count == lanes<double>)
            return narrow(to, values);
    alignas(vector_alignment) std::array<double, lanes<double>> flat;
    store(flat.data(), values);
    for (std::size_t lane = 0; lane < count; ++lane)
        to[lane] = static_cast<T>(flat[lane]);
}

/// Transforms the kernels, G g Gᵀ, and packs blocks of output channels, each [element][input channel][channel
/// of the block]. Computes in double, several output channels at once: training packs anew after each step.
template <batch_convolution C, extent2d Outputs, class Weight, class T>
[[gnu::flatten]] void pack_tile_weights(const Weight& weight, T* packed) {
    constexpr extent2d side = tile_grid::of(C, Outputs).side;
    constexpr std::size_t kernel = C.kernel.rows, taps = kernel * kernel, width = lanes<double>,
                          block = round_up(block_channels, width);
    // Input channels that are collected before the first is read: a vector load cannot forward from several
    // narrow stores that are still in flight.
    constexpr std::size_t inputs = 8;
    alignas(vector_alignment) std::array<std::array<std::array<double, block>, taps>, inputs> collected{};
    for (std::size_t first = 0; first < C.output.channels; first += block_channels) {
        const std::size_t count = std::min(block_channels, C.output.channels - first),
                          distance = odd_lines<T>(C.input.channels * count);
        for (std::size_t input = 0; input < C.input.channels; ++input) {
            if (input % inputs == 0)
                for (std::size_t i = 0; i < std::min(inputs, C.input.channels - input); ++i)
                    for (std::size_t channel = 0; channel < count; ++channel)
                        for (std::size_t tap = 0; tap < taps; ++tap)
                            collected[i][tap][channel] = static_cast<double>(
                                weight(first + channel, input + i, tap / kernel, tap % kernel));
            for (std::size_t lane = 0; lane < count; lane += width) {
                std::array<std::array<vector<double>, kernel>, side.rows> half;
#pragma GCC unroll 64
                for (std::size_t column = 0; column < kernel; ++column) {
                    std::array<vector<double>, kernel> taps_of_row;
#pragma GCC unroll 64
                    for (std::size_t row = 0; row < kernel; ++row)
                        taps_of_row[row] =
                            load(collected[input % inputs][row * kernel + column].data() + lane);
                    const auto line = detail::tile_kernel_line<side.rows>(taps_of_row);
#pragma GCC unroll 64
                    for (std::size_t row = 0; row < side.rows; ++row)
                        half[row][column] = line[row];
                }
                T* to = packed + input * count + lane;
                const std::size_t left = std::min(count - lane, width);
#pragma GCC unroll 64
                for (std::size_t row = 0; row < side.rows; ++row) {
                    const auto line = detail::tile_kernel_line<side.columns>(half[row]);
#pragma GCC unroll 64
                    for (std::size_t column = 0; column < side.columns; ++column, to += distance)
                        put_lanes(to, line[column], left);
                }
            }
        }
        packed += side.area() * distance;
    }
}

/// Multiplies one element of `Tiles` tiles: products[filter][tile] = Σ over channels of
/// transformed[channel][tile] × weights[channel][filter].
template <std::size_t Channels, std::size_t Filters, std::size_t Tiles, class T>
[[gnu::always_inline]] inline void multiply_element(const T* transformed, const T* weights, T* products) {
    std::array<std::array<vector<T>, Tiles>, Filters> sums;
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f)
        sums[f].fill(vector<T>(T{}));
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

/// Winograd convolution by the cheapest tiles.
template <batch_convolution C, class T, extent2d Outputs = best_tile(C)>
struct winograd_lane_method {
    static constexpr const char* name = "winograd";
    static constexpr extent2d tile = Outputs; ///< outputs of a tile
    static constexpr bool applicable = tile != extent2d(0) && winograd_possible(C, tile);
    static constexpr std::size_t half_products = winograd_cost(C, tile);

    static constexpr tile_grid tiles = tile_grid::of(C, applicable ? tile : extent2d(2));
    static constexpr std::size_t elements = tiles.elements(); ///< of an input tile
    static constexpr std::size_t channels = C.input.channels, filters = C.output.channels;
    /// Output channels × tiles of a register block.
    static constexpr std::size_t block_filters = std::min(block_channels, filters),
                                 block = std::min(block_outputs, tiles.count());
    /// Tiles that are computed from the first transform to the last at once: as many as half of the
    /// second-level cache holds, but at least a register block.
    static constexpr std::size_t band = [] {
        constexpr std::size_t tile_bytes = elements * (channels + block_filters) * lanes<T> * sizeof(T);
        const std::size_t most = std::max(l2_cache_bytes / 2 / tile_bytes / block * block, block);
        return std::min(most, tiles.count());
    }();
    /// From one element of a tile to the next, of transformed inputs and of products.
    static constexpr std::size_t input_distance = odd_lines<T>(band * channels * lanes<T>),
                                 product_distance = odd_lines<T>(band * block_filters * lanes<T>);
    static constexpr std::size_t packed_elements = tile_weights_before<C, T>(elements, filters);
    static constexpr std::size_t workspace_elements = elements * (input_distance + product_distance);

    /// `weight(output, input, row, column)` returns one weight.
    template <class Weight>
    static void pack(const Weight& weight, T* to) {
        pack_tile_weights<C, tile>(weight, to);
    }

    /// output = bias + convolution of the input. `bias` may be null.
    [[gnu::flatten]] static void run(const T* packed, const T* bias, const T* input, T* output,
                                     T* workspace) {
        constexpr std::size_t width = lanes<T>;
        constexpr plane_layout planes{channels, C.input.area() * width, width};
        T* const products = workspace + elements * input_distance;
        blocked<tiles.count(), band>([&](auto tiles_of_band, std::size_t first_tile) {
            for (std::size_t i = 0; i < tiles_of_band; ++i) {
                const place_in_band at(i, tiles_of_band);
                transform_input_tile<C, tile>(input, planes, first_tile + i,
                                              workspace + (at.first * channels + i - at.first) * width,
                                              at.count, input_distance);
            }
            blocked<filters, block_filters>([&](auto count, std::size_t first_filter) {
                const T* const weights = packed + tile_weights_before<C, T>(elements, first_filter);
                for (std::size_t e = 0; e < elements; ++e)
                    blocked<tiles_of_band, block>([&](auto tile_count, std::size_t i) {
                        multiply_element<channels, count, tile_count>(
                            workspace + e * input_distance + i * channels * width,
                            weights + e * odd_lines<T>(channels * count),
                            products + e * product_distance + i * count * width);
                    });
                transform_output_band<count>(products, bias ? bias + first_filter : nullptr,
                                             output + first_filter * C.output.area() * width, first_tile,
                                             first_tile + tiles_of_band);
            });
        });
    }

private:
    /// The register block of a tile of a band.
    struct place_in_band {
        std::size_t first; ///< the block's first tile
        std::size_t count; ///< the block's tiles
        constexpr place_in_band(std::size_t i, std::size_t tiles_of_band)
            : first(i / block * block), count(std::min(block, tiles_of_band - first)) {}
    };

    /// The outputs of the tiles [first_tile, last_tile), one band, of `Filters` output channels.
    template <std::size_t Filters>
    [[gnu::flatten, gnu::noinline]] static void transform_output_band(const T* products, const T* bias,
                                                                      T* output, std::size_t first_tile,
                                                                      std::size_t last_tile) {
        for (std::size_t i = 0; i < last_tile - first_tile; ++i) {
            const place_in_band at(i, last_tile - first_tile);
            const std::size_t y = (first_tile + i) / tiles.columns * tile.rows,
                              x = (first_tile + i) % tiles.columns * tile.columns;
            for (std::size_t f = 0; f < Filters; ++f)
                transform_output_tile(products +
                                          (at.first * Filters + f * at.count + i - at.first) * lanes<T>,
                                      bias ? bias[f] : T{},
                                      output + (f * C.output.area() + y * C.output.columns + x) * lanes<T>,
                                      C.output.rows - y, C.output.columns - x);
        }
    }
    /// Aᵀ m A + bias of one tile of one output channel. At most the rows and columns that are left are
    /// stored.
    [[gnu::always_inline]] static void transform_output_tile(const T* products, T bias, T* output,
                                                             std::size_t rows_left,
                                                             std::size_t columns_left) {
        constexpr extent2d side = tiles.side;
        std::array<std::array<vector<T>, side.columns>, tile.rows> half;
#pragma GCC unroll 64
        for (std::size_t x = 0; x < side.columns; ++x) {
            std::array<vector<T>, side.rows> column;
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side.rows; ++y)
                column[y] = load(products + (y * side.columns + x) * product_distance);
            const std::array<vector<T>, tile.rows> sums = detail::tile_output_line<tile.rows>(column);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < tile.rows; ++y)
                half[y][x] = sums[y];
        }
        const vector<T> start(bias);
#pragma GCC unroll 64
        for (std::size_t y = 0; y < tile.rows; ++y) {
            if (y > 0 && y >= rows_left)
                continue;
            const std::array<vector<T>, tile.columns> line = detail::tile_output_line<tile.columns>(half[y]);
#pragma GCC unroll 64
            for (std::size_t x = 0; x < tile.columns; ++x)
                if (x == 0 || x < columns_left)
                    store(output + (y * C.output.columns + x) * lanes<T>, line[x] + start);
        }
    }
};

}}} // namespace tactnet::kernels
