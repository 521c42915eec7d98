#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

// The tiles of Winograd convolutions of one frame: which tile is the cheapest, and how a convolution is cut
// into tiles.
//
// A tile of 2 × 2 outputs of a 3 × 3 kernel takes 16 products per channel instead of 36, a tile of 4 × 4
// takes 36 instead of 144: input tiles and kernels are transformed, multiplied element by element (a matrix
// product over the channels for each element) and transformed back. With d the input tile, g the kernel, y
// the outputs: y = Aᵀ [(G g Gᵀ) ∘ (Bᵀ d B)] A (simd/tile_lines.hpp). A tile of outputs holds whole windows of
// the pool.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Whether the input also lies in whole vectors.
[[nodiscard]] constexpr bool tile_possible(const frame_convolution& c, extent2d outputs) {
    return tile_shape_possible(c, outputs) &&
           c.input_in_vectors_of(lanes_for<float>(c.window.input.channels));
}
/// Whether register blocks have enough sums. Blocks of few sums wait for the weights, unless four tiles share
/// each of them.
[[nodiscard]] constexpr bool tiles_fill_blocks(const frame_convolution& c, extent2d outputs) {
    const std::size_t count = tile_count(c, outputs), vectors = tile_block_vectors(c, count),
                      tiles = tiles_of_block(count, vectors);
    return tiles >= 4 || tiles * vectors >= 8;
}

/// The costs of Winograd's tiles, in the unit of frame_method.
struct tile_costs {
    /// A vector of weights, which is not read more quickly than from the second level of cache, or from
    /// memory further away if a layer has too many: with few tiles, their products wait for it.
    static constexpr std::uint64_t near_weight = 50, far_weight = 180;
    /// Bytes of weights that count as far. Not the configured size of the second level (caches.hpp): other
    /// tiles round differently, and the bits of a network must not depend on it.
    static constexpr std::size_t max_near_bytes = 512 * 1024;
    /// The cost of a vector in a layer of so many bytes of weights; far_bytes_per_cycle as in caches.hpp.
    static constexpr std::uint64_t weight(std::size_t vector, std::size_t layer,
                                          std::size_t bytes_per_cycle) {
        return bytes_per_cycle > 0 ? frame_method::product * products_of_far_bytes(vector, bytes_per_cycle)
               : layer > max_near_bytes ? far_weight
                                        : near_weight;
    }
    /// The cost of the transforms per vector of an input tile and of products. Wide vectors hide all but one
    /// operation after the products; each direction with irrational points costs more. Narrow vectors pay
    /// for every load, addition and store.
    static constexpr std::uint64_t input(extent2d side) {
        return frame_method::wide_vectors ? hidden(side) : 80;
    }
    static constexpr std::uint64_t output(extent2d side) {
        return frame_method::wide_vectors ? hidden(side) : 60;
    }
    /// A tile replaces a smaller one, or direct taps, only if it saves a twentieth of its own cost, since it
    /// has more weights and larger errors.
    static constexpr std::uint64_t to_replace(std::uint64_t cost) { return cost * 20 / 21; }

private:
    static constexpr std::uint64_t hidden(extent2d side) {
        const int with_roots = (side.rows > 4 ? 1 : 0) + (side.columns > 4 ? 1 : 0);
        return with_roots == 0 ? 20 : with_roots == 1 ? 30 : 50;
    }
};

/// The cost of a convolution by tiles of so many outputs.
[[nodiscard]] constexpr std::uint64_t cost_by_tiles(const frame_convolution& c, extent2d outputs,
                                                    std::size_t bytes_per_cycle = far_bytes_per_cycle) {
    const std::size_t channels = c.window.input.channels, input_lanes = lanes_for<float>(channels),
                      input_vectors = ceil_div(channels, input_lanes);
    const extent2d side = tile_side(c, outputs);
    const std::uint64_t elements = side.area(), count = tile_count(c, outputs);
    const std::uint64_t of_channel = std::max(
        frame_method::product * count,
        tile_costs::weight(c.width() * sizeof(float),
                           side.area() * channels * c.padded_filters() * sizeof(float), bytes_per_cycle));
    return elements *
           (channels * c.vectors() * of_channel +
            count * (tile_costs::input(side) * input_vectors + tile_costs::output(side) * c.vectors()));
}

/// Rows and columns of the outputs of the cheapest tile; 0 if none is possible.
[[nodiscard]] constexpr extent2d best_tile(const frame_convolution& c,
                                           std::size_t bytes_per_cycle = far_bytes_per_cycle) {
    if (!tile_possible(c, 2) || !tiles_fill_blocks(c, 2))
        return 0;
    extent2d best = 2;
    // Narrow vectors spend on transforms what larger tiles save.
    std::uint64_t least = tile_costs::to_replace(cost_by_tiles(c, 2, bytes_per_cycle));
    for (std::size_t rows = 2; frame_method::wide_vectors && rows <= 5; ++rows)
        for (std::size_t columns = 2; columns <= 5; ++columns) {
            const extent2d outputs(rows, columns);
            if (!tile_possible(c, outputs) || !tiles_fill_blocks(c, outputs) ||
                cost_by_tiles(c, outputs, bytes_per_cycle) >= least)
                continue;
            best = outputs;
            least = cost_by_tiles(c, outputs, bytes_per_cycle);
        }
    return best;
}

/// A convolution cut into tiles of so many outputs, with the tiles of several frames in one list. The packed
/// kernels do not depend on the number of frames. Sizes only.
template <frame_convolution C, extent2d Outputs, std::size_t Frames = 1>
struct winograd_tiles {
    static_assert(tile_possible(C, Outputs), "winograd_tiles: this convolution has no such tile");
    static constexpr extent2d side = tile_side(C, Outputs);
    static constexpr std::size_t elements = side.area(); ///< of an input tile and of a transformed kernel
    static constexpr std::size_t rows = ceil_div(C.rows(), Outputs.rows),
                                 columns = ceil_div(C.columns(), Outputs.columns);
    static constexpr std::size_t tiles_per_frame = tile_count(C, Outputs); ///< tiles of one frame
    static constexpr std::size_t count = Frames * tiles_per_frame;

    static constexpr std::size_t channels = C.window.input.channels;
    static constexpr std::size_t input_width = lanes_for<float>(channels);
    static constexpr std::size_t input_vectors = ceil_div(channels, input_width);
    static constexpr std::size_t input_stride = input_vectors * input_width;
    static constexpr std::size_t block_vectors = tile_block_vectors(C, tiles_per_frame);
    static constexpr std::size_t block_stride = block_vectors * C.width();
    static constexpr std::size_t weight_bytes = elements * channels * C.padded_filters() * sizeof(float);

    /// Tiles of a band, which passes all transforms before the next begins: as many as the first level of
    /// cache holds if the kernels are small enough to be read again for each band; otherwise all.
    static constexpr std::size_t band = [] {
        constexpr std::size_t of_a_tile = elements * (input_stride + block_stride) * sizeof(float);
        constexpr std::size_t most = std::max<std::size_t>(l1_map_bytes / of_a_tile, 8);
        if (weight_bytes > l2_weight_bytes)
            return count;
        const std::size_t bands = ceil_div(count, most);
        return ceil_div(count, bands);
    }();
    /// Tiles in a register block.
    static constexpr std::size_t block = tiles_of_block(band, block_vectors);

    /// From one element of all tiles to the next, of the transformed input and of the products.
    static constexpr std::size_t input_distance = tile_distance<float>(band * input_stride, elements),
                                 product_distance = tile_distance<float>(band * block_stride, elements);
    /// Elements of workspace.
    static constexpr std::size_t transformed_input = pad_to_cache_line(elements * input_distance),
                                 products = pad_to_cache_line(elements * product_distance);
    static constexpr std::size_t workspace = transformed_input + products;
};

}}} // namespace tactnet::kernels
