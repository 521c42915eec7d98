#pragma once

#include <tactnet/kernels/batch/tiles/group_tiles.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <cstddef>

// The gradient of a convolution with respect to its weights by tiles: Gᵀ [Σ (Bᵀ d B) ∘ (A δ Aᵀ)] G, with d
// the input tile, δ the gradient of the outputs, and the sum over all tiles of all samples: the bilinear form
// of the convolution itself, with other arguments. A vector holds channels of one sample, or filters, so that
// every lane is a sum of its own; the other factor is one number. Here is how the work is cut.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Registers of a block of sums: vectors of what lies in lanes, and numbers that meet them.
template <class T>
struct gradient_block {
    bool filters_in_lanes;        ///< else channels
    std::size_t in_lanes;         ///< of these as many
    std::size_t others;           ///< as many of what does not
    std::size_t vectors, numbers; ///< of a block

    /// Of a convolution's weights.
    [[nodiscard]] static constexpr gradient_block of(const batch_convolution& c) {
        const std::size_t channels = c.input.channels, filters = c.output.channels;
        // Two vectors share each number that is spread.
        const auto vectors_of = [](std::size_t count) {
            return count % lanes<T> > 0 ? std::size_t{0} : std::min<std::size_t>(count / lanes<T>, 2);
        };
        const bool by_filters = vectors_of(filters) > vectors_of(channels);
        const std::size_t in_lanes = by_filters ? filters : channels,
                          others = by_filters ? channels : filters,
                          vectors = std::max<std::size_t>(vectors_of(in_lanes), 1);
        return {by_filters, in_lanes, others, vectors, std::min(max_block_sums / vectors, others)};
    }
    /// Whether one of the two is a multiple of the lanes.
    [[nodiscard]] constexpr bool fills_vectors() const { return lanes<T> > 1 && in_lanes % lanes<T> == 0; }
    /// Blocks of what lies in lanes.
    [[nodiscard]] constexpr std::size_t vector_blocks() const {
        return (in_lanes + vectors * lanes<T> - 1) / (vectors * lanes<T>);
    }
};

/// Bytes of one row of tiles, transformed, of one block.
template <class T>
[[nodiscard]] constexpr std::size_t bytes_of_tile_row(const batch_convolution& c, extent2d outputs) {
    const group_tiles tiles = group_tiles::of(c, outputs);
    const auto block = gradient_block<T>::of(c);
    return tiles.elements() * tiles.columns * (block.vectors * lanes<T> + block.numbers) * lanes<T> *
           sizeof(T);
}
/// Rows of tiles from the first transform to the last; their products are added up in the network's
/// precision. Not by a configured size of a cache: trainings have the same bits on all cores.
template <class T>
[[nodiscard]] constexpr std::size_t tile_rows_of_band(const batch_convolution& c, extent2d outputs) {
    return std::clamp<std::size_t>(std::size_t{512} * 1024 / bytes_of_tile_row<T>(c, outputs), 1,
                                   group_tiles::of(c, outputs).rows);
}

/// Whether there is such a way: channels or filters fill whole vectors, and one row of tiles, transformed,
/// takes a megabyte at most.
template <class T>
[[nodiscard]] constexpr bool tiled_gradient_possible(const batch_convolution& c, extent2d outputs) {
    return gradient_block<T>::of(c).fills_vectors() && group_tile_possible(c, outputs) &&
           bytes_of_tile_row<T>(c, outputs) <= std::size_t{1024} * 1024;
}

/// What it costs, in halves of a product as a convolution (group_tiles.hpp). A sum that goes to its total, in
/// double, is counted as a product.
template <class T>
[[nodiscard]] constexpr std::size_t gradient_cost_by_tiles(const batch_convolution& c, extent2d outputs) {
    const group_tiles tiles = group_tiles::of(c, outputs);
    const auto block = gradient_block<T>::of(c);
    const std::size_t weights = block.in_lanes * block.others, rows = tile_rows_of_band<T>(c, outputs),
                      bands = (tiles.rows + rows - 1) / rows,
                      transformed = block.in_lanes + block.others * block.vector_blocks();
    return tiles.elements() *
           (tiles.count() * (2 * weights + transform_cost(tiles.side) * transformed) + 2 * bands * weights);
}

/// How it is blocked by tiles of so many outputs.
template <sliding_window W, std::size_t Filters, extent2d Outputs, class T>
struct tiled_gradient_plan {
    /// The convolution itself.
    static constexpr batch_convolution ahead = batch_convolution::forward(W, Filters);
    static_assert(tiled_gradient_possible<T>(ahead, Outputs), "tiled_gradient_plan: there is no such way");
    /// Its map, cut.
    static constexpr group_tiles tiles = group_tiles::of(ahead, Outputs);
    static constexpr std::size_t elements = tiles.elements(); ///< of an input tile

    /// Registers.
    static constexpr auto block = gradient_block<T>::of(ahead);
    /// Of all blocks.
    static constexpr std::size_t vectors = block.in_lanes / lanes<T>, numbers = block.others;
    /// Blocks of numbers, for each block of vectors.
    static constexpr std::size_t number_blocks = (numbers + block.numbers - 1) / block.numbers;
    /// Pieces of work that write different sums, and so may run on different threads.
    static constexpr std::size_t pieces = block.vector_blocks() * number_blocks;

    /// Rows of tiles in a band, and tiles.
    static constexpr std::size_t band_rows = tile_rows_of_band<T>(ahead, Outputs),
                                 band_tiles = band_rows * tiles.columns;
    /// The map that goes to the lanes.
    static constexpr shape turned_map = block.filters_in_lanes ? ahead.output : ahead.input;
    /// Rows of it that a band reads.
    static constexpr std::size_t turned_rows =
        std::min((band_rows - 1) * Outputs.rows + (block.filters_in_lanes ? Outputs.rows : tiles.side.rows),
                 turned_map.rows);
    static constexpr std::size_t planes = lanes<T> * block.vectors; ///< vectors of a pixel
    /// Elements of these, turned.
    static constexpr std::size_t turned = turned_rows * turned_map.columns * planes * lanes<T>;
    /// From one element of a tile to the next, of transformed vectors and numbers.
    static constexpr std::size_t vector_distance = odd_lines<T>(band_tiles * planes * lanes<T>),
                                 number_distance = odd_lines<T>(band_tiles * block.numbers * lanes<T>);
    /// Elements that a thread needs.
    static constexpr std::size_t scratch = turned + elements * (vector_distance + number_distance);
    /// Sums, in the order of use: blocks of vectors, of numbers, then [element][number][lane].
    static constexpr std::size_t totals = elements * vectors * lanes<T> * numbers;
    /// Of these, those before a block of so many vectors.
    static constexpr std::size_t totals_before(std::size_t first_vector, std::size_t first_number,
                                               std::size_t vectors_of_block) {
        return elements * lanes<T> * (first_vector * numbers + first_number * vectors_of_block);
    }
};

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
