#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/convolution/tile_lines.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

// The tiles of Winograd convolutions in integers, which multiply words of 16 bits: which tile is the
// cheapest, how a convolution is cut into tiles, and how kernels are packed. Outputs of tiles are too large
// by a constant factor 2ᵏ q, with q = 1, 3 or 9: they are multiplied by the inverse of q modulo 2³² and
// divided by 2ᵏ without a remainder. The sums equal those of the direct method.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The sizes and the cost of a convolution of bytes without groups by tiles of so many outputs.
struct integer_tiling {
    frame_convolution c;
    extent2d outputs;

    /// Inputs that one instruction multiplies.
    static constexpr std::size_t group = word_products<max_integer_lanes>::group;

    [[nodiscard]] constexpr std::size_t width() const { return std::min(c.width(), max_integer_lanes); }
    [[nodiscard]] constexpr std::size_t vectors() const { return c.padded_filters() / width(); }
    /// Rows and columns of an input tile, and of the transformed kernel.
    [[nodiscard]] constexpr extent2d side() const { return tile_side(c, outputs); }
    [[nodiscard]] constexpr std::size_t count() const { return tile_count(c, outputs); }
    /// Vectors of filters in a register block: more if few tiles would leave it empty.
    [[nodiscard]] constexpr std::size_t block_vectors() const {
        return count() * 4 < max_block_sums && vectors() % 4 == 0 ? 4 : std::min<std::size_t>(vectors(), 2);
    }
    /// Channels per vector of words.
    [[nodiscard]] constexpr std::size_t input_width() const {
        std::size_t w = std::max<std::size_t>(2 * max_integer_lanes, group);
        while (c.input_stride % w != 0)
            w /= 2;
        return w;
    }
    /// Channels of the transformed input, and groups of channels that are multiplied.
    [[nodiscard]] constexpr std::size_t channels() const {
        return round_up(c.window.input.channels, input_width());
    }
    [[nodiscard]] constexpr std::size_t groups() const { return ceil_div(c.window.input.channels, group); }
    /// Bytes of the transformed, packed kernels.
    [[nodiscard]] constexpr std::size_t weight_bytes() const {
        return side().area() * groups() * group * c.padded_filters() * sizeof(std::int16_t);
    }
    /// The factor by which outputs are too large, and its power of two.
    [[nodiscard]] constexpr std::uint32_t scale() const {
        return detail::line_scale(side().rows) * detail::line_scale(side().columns);
    }
    [[nodiscard]] constexpr int shift() const { return std::countr_zero(scale()); }

    /// Whether tiles can compute it: lines of them have transforms, groups lie within vectors of channels,
    /// and sums of products, times the power of two, leave a bit for the sign.
    [[nodiscard]] constexpr bool possible() const {
        return max_integer_lanes > 1 && c.groups == 1 && tile_shape_possible(c, outputs) &&
               input_width() % group == 0 &&
               std::uint64_t{c.taps()} * 127 * 255 < (std::uint64_t{1} << (31 - shift()));
    }
    /// Whether register blocks have enough sums.
    [[nodiscard]] constexpr bool fills_blocks() const {
        return tiles_of_block(count(), block_vectors()) * block_vectors() >= 8;
    }
    /// Instructions on vectors: products, which wait for weights if there are few tiles, and transforms with
    /// their loads and stores. A twentieth more than that, since tiles have more weights than taps.
    [[nodiscard]] constexpr std::size_t cost() const {
        const std::size_t weight = far_bytes_per_cycle > 0
                                       ? products_of_far_bytes(width() * group * sizeof(std::int16_t),
                                                               std::max<std::size_t>(far_bytes_per_cycle, 1))
                                   : weight_bytes() > l2_cache_bytes ? far_weight
                                                                     : near_weight,
                          products = groups() * vectors() *
                                     std::max(instructions::word_product_cost * count(), weight),
                          lines = line_cost(side().rows) + line_cost(side().columns),
                          inputs = (5 + lines) * count() * (channels() / input_width()),
                          of_outputs = (3 + lines) * count() * vectors();
        return side().area() * (products + inputs + of_outputs) / 20 * 21;
    }

private:
    static constexpr std::size_t near_weight = 3, far_weight = 6;
    /// What longer lines cost per element in addition to those of four.
    static constexpr std::size_t line_cost(std::size_t length) { return length > 4 ? length - 3 : 0; }
};

/// Rows and columns of the outputs of the cheapest tile; 0 if none is possible.
[[nodiscard]] constexpr extent2d best_integer_tile(const frame_convolution& c) {
    extent2d best = 0;
    std::size_t least = 0;
    for (std::size_t rows = 2; rows <= 5; ++rows)
        for (std::size_t columns = 2; columns <= 5; ++columns) {
            const integer_tiling tiling{c, {rows, columns}};
            if (!tile_shape_possible(c, tiling.outputs) || !tiling.possible() || !tiling.fills_blocks())
                continue;
            const std::size_t cost = tiling.cost();
            if (best == extent2d(0) || cost < least)
                best = tiling.outputs, least = cost;
        }
    return best;
}

/// How a convolution is cut into tiles.
template <frame_convolution C, extent2d Outputs>
struct integer_tiles {
    static constexpr integer_tiling tiling{C, Outputs};
    static constexpr extent2d outputs = Outputs, side = tiling.side();
    static constexpr std::size_t elements = side.area(), width = tiling.width(), vectors = tiling.vectors(),
                                 block_vectors = tiling.block_vectors(), count = tiling.count(),
                                 columns = ceil_div(C.columns(), Outputs.columns);
    using products = word_products<width>;
    static constexpr std::size_t group = products::group, groups = tiling.groups(),
                                 input_width = tiling.input_width(), channels = tiling.channels(),
                                 block_stride = block_vectors * width;
    static_assert(group == integer_tiling::group);

    /// Tiles that are transformed, multiplied and transformed back together: as many as the first level of
    /// cache holds, if the kernels are small enough to be read once per band; else all.
    static constexpr std::size_t band = [] {
        constexpr std::size_t of_a_tile =
            elements * (channels * sizeof(std::int16_t) + block_stride * sizeof(std::int32_t));
        if (tiling.weight_bytes() > l2_weight_bytes)
            return count;
        constexpr std::size_t most = std::max<std::size_t>(l1_map_bytes / of_a_tile, 8);
        return ceil_div(count, ceil_div(count, most));
    }();
    /// Tiles per register block.
    static constexpr std::size_t block = tiles_of_block(band, block_vectors);

    /// From one element of all tiles to the next, of the transformed input and of the products.
    static constexpr std::size_t input_distance = tile_distance<std::int16_t>(band * channels, elements),
                                 product_distance =
                                     tile_distance<std::int32_t>(band * block_stride, elements);
    /// Bytes of the workspace: transformed inputs, then products.
    static constexpr std::size_t transformed_bytes =
        pad_to_cache_line<std::uint8_t>(elements * input_distance * sizeof(std::int16_t));
    static constexpr std::size_t workspace_bytes =
        transformed_bytes +
        pad_to_cache_line<std::uint8_t>(elements * product_distance * sizeof(std::int32_t));

    /// What divides the outputs: a shift, and the inverse of the odd factor modulo 2³² by Newton's iteration.
    static constexpr int shift = tiling.shift();
    static constexpr std::uint32_t inverse = [] {
        const std::uint32_t odd = tiling.scale() >> shift;
        std::uint32_t x = odd;
        for (int i = 0; i < 5; ++i)
            x *= 2 - odd * x;
        return x;
    }();
};

/// Packs transformed kernels in the order of use: blocks of vectors of filters, then [element][group of
/// channels][filter of the block][channel of the group], words of 16 bits. `weight(filter, channel, row,
/// column)`.
template <frame_convolution C, class Tiles, class Weight>
constexpr void pack_integer_tiles(const Weight& weight, std::int8_t* packed) {
    constexpr std::size_t kernel = C.window.kernel.rows, group = Tiles::group;
    constexpr extent2d side = Tiles::side;
    for (std::size_t first = 0; first < Tiles::vectors; first += Tiles::block_vectors) {
        const std::size_t filters = std::min(Tiles::block_vectors, Tiles::vectors - first) * Tiles::width;
        for (std::size_t channel = 0; channel < Tiles::groups * group; ++channel)
            for (std::size_t f = 0; f < filters; ++f) {
                const std::size_t filter = first * Tiles::width + f;
                std::array<std::array<int, kernel>, side.rows> half{};
                for (std::size_t column = 0;
                     column < kernel && filter < C.filters && channel < C.window.input.channels; ++column) {
                    std::array<int, kernel> g{};
                    for (std::size_t row = 0; row < kernel; ++row)
                        g[row] = weight(filter, channel, row, column);
                    for (std::size_t line = 0; line < side.rows; ++line)
                        half[line][column] = detail::integer_kernel_element<side.rows>(line, g);
                }
                for (std::size_t e = 0; e < Tiles::elements; ++e) {
                    const auto word = static_cast<std::int16_t>(detail::integer_kernel_element<side.columns>(
                        e % side.columns, half[e / side.columns]));
                    const auto bytes = tactnet::detail::bits_as<std::array<std::int8_t, 2>>(word);
                    std::int8_t* const to =
                        packed +
                        2 * (((e * Tiles::groups + channel / group) * filters + f) * group + channel % group);
                    to[0] = bytes[0], to[1] = bytes[1];
                }
            }
        packed += 2 * Tiles::elements * Tiles::groups * group * filters;
    }
}

}}} // namespace tactnet::kernels
