#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame_convolution.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>

// The shapes of the tiles of Winograd convolutions, in floats (kernels/frame/winograd_tiles.hpp) and in
// integers (kernels/integer/convolution/winograd_tiles.hpp).

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Rows and columns of an input tile and of the transformed kernel, for a tile of so many outputs.
[[nodiscard]] constexpr extent2d tile_side(const frame_convolution& c, extent2d outputs) {
    return {outputs.rows + c.window.kernel.rows - 1, outputs.columns + c.window.kernel.columns - 1};
}
/// The number of tiles that cover the outputs.
[[nodiscard]] constexpr std::size_t tile_count(const frame_convolution& c, extent2d outputs) {
    return ceil_div(c.rows(), outputs.rows) * ceil_div(c.columns(), outputs.columns);
}
/// Vectors of filters in a register block of tiles × vectors: more if few tiles would leave it empty.
[[nodiscard]] constexpr std::size_t tile_block_vectors(const frame_convolution& c, std::size_t tiles) {
    return tiles * 4 < max_block_sums && c.vectors() % 4 == 0 ? 4 : c.block_vectors();
}
/// Tiles in a register block: as many as registers allow, in blocks of nearly the same size.
[[nodiscard]] constexpr std::size_t tiles_of_block(std::size_t tiles, std::size_t vectors) {
    const std::size_t most = std::max<std::size_t>(max_block_sums / vectors, 1);
    const std::size_t blocks = ceil_div(tiles, most);
    return ceil_div(tiles, blocks);
}

/// The distance from one element of all tiles to the next, for `count` numbers of each element: an odd number
/// of cache lines if the first level of cache could not hold a line of each element otherwise. It keeps lines
/// whose addresses differ by whole pages in few places.
template <class T>
[[nodiscard]] constexpr std::size_t tile_distance(std::size_t count, std::size_t elements) {
    constexpr std::size_t lines_of_page = 4096 / cache_line;
    const std::size_t lines = ceil_div(count * sizeof(T), cache_line),
                      lines_together = std::gcd(lines, lines_of_page);
    return elements * lines_together * cache_line > l1_cache_bytes ? odd_lines<T>(count) : count;
}

/// Whether there are transforms for such a tile, and it holds whole windows of the pool.
[[nodiscard]] constexpr bool tile_shape_possible(const frame_convolution& c, extent2d outputs) {
    const extent2d side = tile_side(c, outputs);
    return (c.window.kernel == extent2d(3) || c.window.kernel == extent2d(2)) &&
           c.window.stride == extent2d(1) && (c.pool == extent2d(1) || c.pool == extent2d(2)) &&
           outputs.rows % c.pool.rows == 0 && outputs.columns % c.pool.columns == 0 &&
           std::min(outputs.rows, outputs.columns) >= 2 && std::max(side.rows, side.columns) <= 6;
}

}}} // namespace tactnet::kernels
