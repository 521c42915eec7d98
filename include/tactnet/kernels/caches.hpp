#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/config.hpp>
#include <tactnet/kernels/frame_convolution.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>

// The caches of one core, by which kernels cut their work into parts that stay in cache. Sizes change times,
// never results: each output is the same sum in the same order.
//
// Configuration: for a known processor, define TACTNET_L1_CACHE_KIB and TACTNET_L2_CACHE_KIB, plain numbers
// of KiB, before the first header of the library. Nearly every processor with vectors has at least the
// defaults. Translation units with other sizes use namespaces of their own, like those for other instruction
// sets (config.hpp).
#if (defined(TACTNET_L1_CACHE_KIB) && defined(TACTNET_L1_CACHE_BY_DEFAULT)) ||                               \
    (defined(TACTNET_L2_CACHE_KIB) && defined(TACTNET_L2_CACHE_BY_DEFAULT)) ||                               \
    (defined(TACTNET_FAR_BYTES_PER_CYCLE) && defined(TACTNET_FAR_BY_DEFAULT))
#error                                                                                                       \
    "tactnet: define TACTNET_L1_CACHE_KIB, TACTNET_L2_CACHE_KIB and TACTNET_FAR_BYTES_PER_CYCLE before the first header of the library"
#endif

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Bytes of the first level, for data.
#if defined(TACTNET_L1_CACHE_BY_DEFAULT)
inline constexpr std::size_t l1_cache_bytes = 32 * 1024;
#else
inline constexpr std::size_t l1_cache_bytes = TACTNET_L1_CACHE_KIB * std::size_t{1024};
#endif
/// Bytes of the second level.
#if defined(TACTNET_L2_CACHE_BY_DEFAULT)
inline constexpr std::size_t l2_cache_bytes = 512 * 1024;
#else
inline constexpr std::size_t l2_cache_bytes = TACTNET_L2_CACHE_KIB * std::size_t{1024};
#endif
static_assert(
    l1_cache_bytes >= 4096 && l2_cache_bytes >= l1_cache_bytes,
    "tactnet: expected at least 4 KiB of L1 (TACTNET_L1_CACHE_KIB), and of L2 (TACTNET_L2_CACHE_KIB) as "
    "much as of L1");

/// Bytes of weights per cycle from beyond the second level if all weights come from there; 0 by default,
/// which means that those of a layer are near. Define TACTNET_FAR_BYTES_PER_CYCLE, a plain number, where a
/// program does so much other work between frames that nothing of the network stays in the caches, or where
/// the network exceeds them: methods with fewer weights are then chosen. This changes rounding errors of
/// single precision, since other tiles round differently, but no result in 8 bits.
#if defined(TACTNET_FAR_BY_DEFAULT)
inline constexpr std::size_t far_bytes_per_cycle = 0;
#else
inline constexpr std::size_t far_bytes_per_cycle = TACTNET_FAR_BYTES_PER_CYCLE;
#endif
/// Products of vectors, two per cycle, in the time in which so many bytes of weights come.
[[nodiscard]] constexpr std::size_t products_of_far_bytes(std::size_t bytes, std::size_t bytes_per_cycle) {
    return 2 * bytes / bytes_per_cycle;
}

/// The part of the first level for an intermediate map; weights and outputs stream through the rest.
inline constexpr std::size_t l1_map_bytes = l1_cache_bytes / 4 * 3;
/// Up to so many bytes, weights that are read again for each part of a map come quickly enough from the
/// second level.
inline constexpr std::size_t l2_weight_bytes = l2_cache_bytes / 8;

// Hints for weights that are not in the near caches: those of large networks, and all if a program did other
// work since the last frame. Weights lie in the order of use, so what comes next also follows in memory, at
// the end of a layer that of the next one. Results do not depend on them.

/// How far ahead weights are requested where all taps are one stream.
inline constexpr std::size_t prefetch_distance_bytes = 4096;

/// Requests the cache lines of so many bytes. Does nothing if the layer has few weights, or if each of them
/// is used only once: then the loads themselves keep the memory busy. Microcontrollers have no such caches.
template <std::size_t Bytes, std::size_t LayerBytes, std::size_t Uses>
[[gnu::always_inline]] inline void prefetch_weights([[maybe_unused]] const void* from) {
    if constexpr (LayerBytes >= 64 * 1024 && Uses > 1 && lanes<float> > 1 && vector_registers >= 16) {
        const char* const first = static_cast<const char*>(from);
#pragma GCC unroll 64
        for (std::size_t byte = 0; byte < Bytes; byte += cache_line)
            __builtin_prefetch(first + byte);
    }
}

// The shapes of the tiles of Winograd convolutions, in floats (kernels/frame/winograd_tiles.hpp) and in
// integers (kernels/integer/convolution/winograd_tiles.hpp).

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
