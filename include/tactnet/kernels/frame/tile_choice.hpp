#pragma once

#include <tactnet/kernels/frame/direct.hpp>

#include <algorithm>
#include <cstddef>

// Which of Winograd's tiles a convolution is computed by, or none. Decided when compiling, from sizes and the
// instruction set.
//
// Costs are counted in products of a vector. Their few constants, in one place below, are rounded from times
// of layers (benchmark_plan) on processors of several kinds, with 16 and 32 registers.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Rows and columns of an input tile, and of the transformed kernel, for a tile of so many outputs.
[[nodiscard]] constexpr extent2d tile_side(const frame_convolution& c, extent2d outputs) {
    return {outputs.rows + c.window.kernel.rows - 1, outputs.columns + c.window.kernel.columns - 1};
}
/// Tiles that cover the outputs.
[[nodiscard]] constexpr std::size_t tile_count(const frame_convolution& c, extent2d outputs) {
    return (c.rows() + outputs.rows - 1) / outputs.rows *
           ((c.columns() + outputs.columns - 1) / outputs.columns);
}
/// Vectors of filters in a register block of tiles × vectors: more where there are few tiles to fill it.
[[nodiscard]] constexpr std::size_t tile_block_vectors(const frame_convolution& c, std::size_t tiles) {
    return tiles * 4 < max_block_sums && c.vectors() % 4 == 0 ? 4 : c.block_vectors();
}
/// As many tiles as registers allow, evenly spread.
[[nodiscard]] constexpr std::size_t tiles_of_block(std::size_t tiles, std::size_t vectors) {
    const std::size_t most = std::max<std::size_t>(max_block_sums / vectors, 1);
    const std::size_t blocks = (tiles + most - 1) / most;
    return (tiles + blocks - 1) / blocks;
}

/// Whether there are lines for such a tile (simd/tile_lines.hpp), it holds whole windows of the pool, and the
/// input lies in whole vectors.
[[nodiscard]] constexpr bool tile_possible(const frame_convolution& c, extent2d outputs) {
    const std::size_t channels = c.window.input.channels, width = lanes_for<float>(channels);
    const extent2d side = tile_side(c, outputs);
    return (c.window.kernel == extent2d(3) || c.window.kernel == extent2d(2)) &&
           c.window.stride == extent2d(1) && (c.pool == extent2d(1) || c.pool == extent2d(2)) &&
           outputs.rows % c.pool.rows == 0 && outputs.columns % c.pool.columns == 0 &&
           std::min(outputs.rows, outputs.columns) >= 2 && std::max(side.rows, side.columns) <= 6 &&
           c.input_stride % width == 0 && c.input_stride >= (channels + width - 1) / width * width &&
           c.input_offset_multiple % width == 0;
}

/// What tiles are counted at, in twentieths of a product of a vector.
struct tile_costs {
    static constexpr std::size_t product = 20;      ///< of a vector, the unit of all costs
    static constexpr bool wide = lanes<float> >= 8; ///< whether vectors are wide enough for large tiles
    /// A product of taps. With 16 wide registers a block of taps has too few sums to hide how long a
    /// multiply-add takes, and reaches about 60 % of the peak.
    static constexpr std::size_t tap = wide && vector_registers < 32 ? 26 : product;
    /// A vector of weights, which is not read more quickly than from the second level of cache, or from
    /// further away where a layer has too many: with few tiles their products wait for it.
    static constexpr std::size_t of_near_weight = 50, of_far_weight = 180;
    /// Weights that are taken to lie beyond the second level. Not by its configured size (caches.hpp): other
    /// tiles round otherwise, and the bits of a network are not to depend on that.
    static constexpr std::size_t most_near_bytes = 512 * 1024;
    /// Transforms, for each vector of an input tile. Wide vectors hide them behind the products, but for one
    /// operation, and more with each direction that has points at roots; else each load, addition and store
    /// counts.
    static constexpr std::size_t input(extent2d side) { return wide ? hidden(side) : 80; }
    /// The same for products.
    static constexpr std::size_t output(extent2d side) { return wide ? hidden(side) : 60; }
    /// What a tile must be cheaper than to take the place of a smaller one or of taps, since it has more
    /// weights and larger errors: by a twentieth of its own cost.
    static constexpr std::size_t to_replace(std::size_t cost) { return cost * 20 / 21; }

private:
    static constexpr std::size_t hidden(extent2d side) {
        const int with_roots = (side.rows > 4 ? 1 : 0) + (side.columns > 4 ? 1 : 0);
        return with_roots == 0 ? 20 : with_roots == 1 ? 30 : 50;
    }
};

/// What a convolution costs by such tiles.
[[nodiscard]] constexpr std::size_t cost_by_tiles(const frame_convolution& c, extent2d outputs) {
    const std::size_t channels = c.window.input.channels, input_lanes = lanes_for<float>(channels),
                      input_vectors = (channels + input_lanes - 1) / input_lanes;
    const extent2d side = tile_side(c, outputs);
    const std::size_t elements = side.area(), count = tile_count(c, outputs);
    const bool far = elements * channels * c.padded_filters() * sizeof(float) > tile_costs::most_near_bytes;
    const std::size_t of_channel =
        std::max(tile_costs::product * count, far ? tile_costs::of_far_weight : tile_costs::of_near_weight);
    return elements *
           (channels * c.vectors() * of_channel +
            count * (tile_costs::input(side) * input_vectors + tile_costs::output(side) * c.vectors()));
}

/// Rows and columns of the outputs of a tile; 0 where taps one by one take fewer operations.
[[nodiscard]] constexpr extent2d best_tile(const frame_convolution& c) {
    // Register blocks of few sums wait for the weights, unless four tiles share each of these.
    const auto fills_block = [&](extent2d outputs) {
        const std::size_t count = tile_count(c, outputs), vectors = tile_block_vectors(c, count),
                          tiles = tiles_of_block(count, vectors);
        return tiles >= 4 || tiles * vectors >= 8;
    };
    if (!tile_possible(c, 2) || !fills_block(2))
        return 0;
    const std::size_t by_taps =
        c.window.taps_on_pixels() * c.window.input.channels * c.vectors() * tile_costs::tap;
    const std::size_t by_2 = cost_by_tiles(c, 2);
    extent2d best = by_2 < tile_costs::to_replace(by_taps) ? 2 : 0;
    // Narrow vectors spend on transforms what larger tiles save.
    std::size_t least = tile_costs::to_replace(std::min(by_2, by_taps));
    for (std::size_t rows = 2; tile_costs::wide && rows <= 5; ++rows)
        for (std::size_t columns = 2; columns <= 5; ++columns) {
            const extent2d outputs(rows, columns);
            if (!tile_possible(c, outputs) || !fills_block(outputs) || cost_by_tiles(c, outputs) >= least)
                continue;
            best = outputs;
            least = cost_by_tiles(c, outputs);
        }
    return best;
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
