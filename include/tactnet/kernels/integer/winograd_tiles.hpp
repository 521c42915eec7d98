#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/word_products.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Winograd convolution by tiles of 2 × 2 outputs (kernels/simd/tile_lines.hpp, N = 3 and 4) in integers, for
// instruction sets that multiply words of 16 bits and not bytes. Transformed inputs are sums of four bytes.
// The transform of a 3 × 3 kernel is doubled in each direction, so that ½ becomes 1; the outputs are then
// four times too large and divided by 4 without a remainder. The sums equal those of the direct method.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// How a convolution of bytes without groups is cut into tiles.
template <frame_convolution C>
struct integer_tiles {
    static constexpr std::size_t width = std::min(C.width(), max_integer_lanes);
    using products = word_products<width>;
    static constexpr std::size_t group = products::group;
    static constexpr std::size_t vectors = C.padded_filters() / width, block_vectors = C.block_vectors();

    /// Rows and columns of an input tile, and of the transformed kernel.
    static constexpr std::size_t side = C.window.kernel.rows + 1, elements = side * side;
    static constexpr std::size_t rows = (C.rows() + 1) / 2, columns = (C.columns() + 1) / 2;
    static constexpr std::size_t count = rows * columns;
    /// The binary logarithm of the factor by which the outputs are too large.
    static constexpr int excess = C.window.kernel.rows == 3 ? 2 : 0;

    /// Channels per vector of words, and channels of the transformed input.
    static constexpr std::size_t input_width = [] {
        std::size_t w = std::max<std::size_t>(2 * max_integer_lanes, group);
        while (C.input_stride % w != 0)
            w /= 2;
        return w;
    }();
    static constexpr std::size_t channels = round_up(C.window.input.channels, input_width);
    static constexpr std::size_t groups = ceil_div(C.window.input.channels, group);
    static constexpr std::size_t block_stride = block_vectors * width;

    /// Tiles that are transformed, multiplied and transformed back together: as many as the first level of
    /// cache holds, if the kernels are small enough to be read once per band; else all.
    static constexpr std::size_t band = [] {
        constexpr std::size_t of_a_tile =
            elements * (channels * sizeof(std::int16_t) + block_stride * sizeof(std::int32_t));
        if (elements * groups * group * C.padded_filters() * sizeof(std::int16_t) > l2_weight_bytes)
            return count;
        constexpr std::size_t most = std::max<std::size_t>(l1_map_bytes / of_a_tile, 8);
        return ceil_div(count, ceil_div(count, most));
    }();
    /// Tiles per register block, of `tiles` in all: as many as registers allow, evenly spread.
    static constexpr std::size_t block_of(std::size_t tiles) {
        constexpr std::size_t most = std::max<std::size_t>(max_block_sums / block_vectors, 1);
        return ceil_div(tiles, ceil_div(tiles, most));
    }
    static constexpr std::size_t block = block_of(band);

    /// Bytes of the workspace: transformed inputs, then products.
    static constexpr std::size_t transformed_bytes =
        pad_to_cache_line<std::uint8_t>(elements * band * channels * sizeof(std::int16_t));
    static constexpr std::size_t workspace_bytes =
        transformed_bytes +
        pad_to_cache_line<std::uint8_t>(elements * band * block_stride * sizeof(std::int32_t));
    /// Bytes of the transformed, packed kernels.
    static constexpr std::size_t weight_bytes =
        elements * groups * group * C.padded_filters() * sizeof(std::int16_t);

    /// Whether tiles can compute it. Beyond 1024 channels, sums might need more than 31 bits.
    static constexpr bool possible = (C.window.kernel == extent2d(3) || C.window.kernel == extent2d(2)) &&
                                     C.window.stride == extent2d(1) && max_integer_lanes > 1 &&
                                     (C.pool == extent2d(1) || C.pool == extent2d(2)) && C.groups == 1 &&
                                     input_width % group == 0 && C.window.input.channels <= 1024;
    /// Operations: a product counts twice, since its sum is another operation; transforms count with their
    /// loads and stores.
    static constexpr std::size_t cost = 2 * elements * count * groups * vectors +
                                        5 * elements * count * (channels / input_width) +
                                        3 * elements * count * vectors;
};

/// Packs transformed kernels in the order of use: blocks of vectors of filters, then [element][group of
/// channels][filter of the block][channel of the group], words of 16 bits. `weight(filter, channel, row,
/// column)`.
template <frame_convolution C, class Weight>
constexpr void pack_integer_tiles(const Weight& weight, std::int8_t* packed) {
    using tiles = integer_tiles<C>;
    constexpr std::size_t kernel = tiles::side - 1;
    // A line of G, doubled for kernels of three, times the numbers of a kernel.
    const auto transformed = [](std::size_t line, const std::array<int, kernel>& g) {
        constexpr int times = kernel == 3 ? 2 : 1;
        if (line == 0)
            return times * g[0];
        if (line == kernel)
            return times * g[kernel - 1];
        if constexpr (kernel == 2)
            return g[0] + g[1];
        else
            return g[0] + (line == 1 ? g[1] : -g[1]) + g[2];
    };
    for (std::size_t first = 0; first < tiles::vectors; first += tiles::block_vectors) {
        const std::size_t filters = std::min(tiles::block_vectors, tiles::vectors - first) * tiles::width;
        for (std::size_t channel = 0; channel < tiles::groups * tiles::group; ++channel)
            for (std::size_t f = 0; f < filters; ++f) {
                const std::size_t filter = first * tiles::width + f;
                std::array<std::array<int, kernel>, tiles::side> half{};
                for (std::size_t column = 0;
                     column < kernel && filter < C.filters && channel < C.window.input.channels; ++column) {
                    std::array<int, kernel> g{};
                    for (std::size_t row = 0; row < kernel; ++row)
                        g[row] = weight(filter, channel, row, column);
                    for (std::size_t line = 0; line < tiles::side; ++line)
                        half[line][column] = transformed(line, g);
                }
                for (std::size_t e = 0; e < tiles::elements; ++e) {
                    const auto word =
                        static_cast<std::int16_t>(transformed(e % tiles::side, half[e / tiles::side]));
                    const auto bytes = tactnet::detail::bits_as<std::array<std::int8_t, 2>>(word);
                    std::int8_t* const to =
                        packed +
                        2 * (((e * tiles::groups + channel / tiles::group) * filters + f) * tiles::group +
                             channel % tiles::group);
                    to[0] = bytes[0], to[1] = bytes[1];
                }
            }
        packed += 2 * tiles::elements * tiles::groups * tiles::group * filters;
    }
}

}}} // namespace tactnet::kernels
