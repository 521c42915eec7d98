#pragma once

#include <tactnet/kernels/batch/convolution.hpp>
#include <tactnet/tensor/alignment.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

// Winograd's convolutions of one group of samples, which lie side by side in the lanes: how a map is cut into
// tiles, and by which tiles that takes least, or by none. Both follow from sizes alone, so that a network is
// trained by the same sums on all cores. kernels/simd/tile_lines.hpp has the lines of tiles.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// A map cut into tiles of so many outputs.
struct group_tiles {
    extent2d side;             ///< rows and columns of an input tile, and of the transformed kernel
    std::size_t rows, columns; ///< of tiles that cover the outputs

    /// Of a convolution.
    [[nodiscard]] static constexpr group_tiles of(const batch_convolution& c, extent2d outputs) {
        return {{outputs.rows + c.kernel.rows - 1, outputs.columns + c.kernel.columns - 1},
                (c.output.rows + outputs.rows - 1) / outputs.rows,
                (c.output.columns + outputs.columns - 1) / outputs.columns};
    }
    /// Of an input tile.
    [[nodiscard]] constexpr std::size_t elements() const { return side.area(); }
    /// Of tiles.
    [[nodiscard]] constexpr std::size_t count() const { return rows * columns; }
};

/// Elements from one element of a tile to the next where so many lie between: an odd number of cache lines,
/// so that the elements of a tile do not meet in the same sets of the cache.
template <class T>
[[nodiscard]] constexpr std::size_t odd_lines(std::size_t count) {
    constexpr std::size_t line = alignment / sizeof(T);
    return ((count + line - 1) / line / 2 * 2 + 1) * line;
}

/// Of packed kernels, those before an output channel that begins a block.
template <batch_convolution C, class T>
[[nodiscard]] constexpr std::size_t tile_weights_before(std::size_t elements, std::size_t channel) {
    const std::size_t rest = channel % block_channels;
    return elements * (channel / block_channels * odd_lines<T>(C.input.channels * block_channels) +
                       (rest > 0 ? odd_lines<T>(C.input.channels * rest) : 0));
}

/// Whether there are lines for such a tile, nothing lies between neighbours, and padding above and on the
/// left is less than the kernel.
[[nodiscard]] constexpr bool group_tile_possible(const batch_convolution& c, extent2d outputs) {
    const extent2d side = group_tiles::of(c, outputs).side;
    const auto less_than = [](std::ptrdiff_t padding, std::size_t kernel) {
        return padding >= 0 && static_cast<std::size_t>(padding) < kernel;
    };
    return (c.kernel == extent2d(3) || c.kernel == extent2d(2)) && c.stride == extent2d(1) &&
           c.spacing == extent2d(1) && less_than(c.top, c.kernel.rows) &&
           less_than(c.left, c.kernel.columns) && std::min(outputs.rows, outputs.columns) >= 2 &&
           std::max(side.rows, side.columns) <= 6;
}

/// What an element of a tile is counted at to transform it, of one channel or filter, in halves of a product.
/// Rounded from times of layers (benchmark_training_speed has those of networks): additions are as dear as
/// products, and lines with points at roots have more of them.
[[nodiscard]] constexpr std::size_t transform_cost(extent2d side) {
    return 8 + (side.rows > 4 ? 1 : 0) + (side.columns > 4 ? 1 : 0);
}

/// Of a convolution by such tiles, in halves of a product.
[[nodiscard]] constexpr std::size_t cost_by_group_tiles(const batch_convolution& c, extent2d outputs) {
    const group_tiles tiles = group_tiles::of(c, outputs);
    const std::size_t channels = c.input.channels, filters = c.output.channels;
    return tiles.elements() * tiles.count() *
           (2 * channels * filters + transform_cost(tiles.side) * (channels + filters));
}
/// The same by taps, but those on padding.
[[nodiscard]] constexpr std::size_t cost_by_taps(const batch_convolution& c) {
    const auto on_pixels = [](std::size_t outputs, std::size_t kernel, std::ptrdiff_t before,
                              std::size_t input) {
        const tap_line line = tap_line::of(outputs, kernel, 1, 1, before, input, 0);
        std::size_t taps = 0;
        for (std::size_t i = 0; i < outputs; ++i)
            taps += std::max(line.last_tap(i), line.first_tap(i)) - line.first_tap(i);
        return taps;
    };
    return 2 * on_pixels(c.output.rows, c.kernel.rows, c.top, c.input.rows) *
           on_pixels(c.output.columns, c.kernel.columns, c.left, c.input.columns) * c.input.channels *
           c.output.channels;
}

/// The tiles of outputs that cost least of those that are possible; 0 where `by_taps` is less. Errors grow
/// with tiles, so that one replaces a smaller one, or taps, only where it saves a twentieth.
template <class Possible, class Cost>
[[nodiscard]] constexpr extent2d cheapest_group_tile(std::size_t by_taps, Possible&& possible, Cost&& cost) {
    extent2d best = 0;
    std::size_t least = by_taps;
    for (std::size_t area = 4; area <= 25; ++area)
        for (std::size_t rows = 2; rows <= 5; ++rows) {
            const extent2d outputs(rows, area / rows);
            if (outputs.area() != area || !possible(outputs) || cost(outputs) * 21 >= least * 20)
                continue;
            best = outputs;
            least = cost(outputs);
        }
    return best;
}
/// Of a convolution.
[[nodiscard]] constexpr extent2d best_group_tile(const batch_convolution& c) {
    if (!group_tile_possible(c, 2))
        return 0;
    return cheapest_group_tile(
        cost_by_taps(c), [&](extent2d outputs) { return group_tile_possible(c, outputs); },
        [&](extent2d outputs) { return cost_by_group_tiles(c, outputs); });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
