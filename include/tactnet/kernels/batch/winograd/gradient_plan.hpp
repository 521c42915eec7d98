#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/batch/winograd/tile_grid.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <cstddef>

// How a weight gradient by tiles is blocked, and its cost.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Register blocks of weights: vectors that hold either channels or filters, times broadcast numbers of the
/// other kind.
template <class T>
struct gradient_block {
    bool filters_in_lanes;        ///< else channels
    std::size_t in_lanes;         ///< number of filters or channels in lanes
    std::size_t others;           ///< number of the others
    std::size_t vectors, numbers; ///< of a register block

    [[nodiscard]] static constexpr gradient_block of(const batch_convolution& c) {
        const std::size_t channels = c.input.channels, filters = c.output.channels;
        // Two vectors share each broadcast.
        const auto vectors_of = [](std::size_t count) {
            return count % lanes<T> > 0 ? std::size_t{0} : std::min<std::size_t>(count / lanes<T>, 2);
        };
        const bool by_filters = vectors_of(filters) > vectors_of(channels);
        const std::size_t in_lanes = by_filters ? filters : channels,
                          others = by_filters ? channels : filters,
                          vectors = std::max<std::size_t>(vectors_of(in_lanes), 1);
        return {by_filters, in_lanes, others, vectors, std::min(max_block_sums / vectors, others)};
    }
    [[nodiscard]] constexpr bool fills_vectors() const { return lanes<T> > 1 && in_lanes % lanes<T> == 0; }
    [[nodiscard]] constexpr std::size_t vector_blocks() const {
        return ceil_div(in_lanes, vectors * lanes<T>);
    }
};

/// The bytes of one transformed row of tiles of one block.
template <class T>
[[nodiscard]] constexpr std::size_t bytes_of_tile_row(const batch_convolution& c, extent2d outputs) {
    const tile_grid tiles = tile_grid::of(c, outputs);
    const auto block = gradient_block<T>::of(c);
    return tiles.elements() * tiles.columns * (block.vectors * lanes<T> + block.numbers) * lanes<T> *
           sizeof(T);
}
/// Rows of tiles whose products are accumulated in the working precision. It does not depend on a configured
/// cache size: trainings have the same bits on all cores.
template <class T>
[[nodiscard]] constexpr std::size_t tile_rows_of_band(const batch_convolution& c, extent2d outputs) {
    return std::clamp<std::size_t>(std::size_t{512} * 1024 / bytes_of_tile_row<T>(c, outputs), 1,
                                   tile_grid::of(c, outputs).rows);
}

/// Whether tiles can compute the weight gradient: channels or filters fill whole vectors, and one transformed
/// row of tiles takes a megabyte at most.
template <class T>
[[nodiscard]] constexpr bool winograd_gradient_possible(const batch_convolution& c, extent2d outputs) {
    return gradient_block<T>::of(c).fills_vectors() && winograd_possible(c, outputs) &&
           bytes_of_tile_row<T>(c, outputs) <= std::size_t{1024} * 1024;
}

/// The cost of the weight gradient by tiles, in halves of a multiply-add. A sum that is added to its total,
/// in double, counts as a multiply-add.
template <class T>
[[nodiscard]] constexpr std::size_t winograd_gradient_cost(const batch_convolution& c, extent2d outputs) {
    const tile_grid tiles = tile_grid::of(c, outputs);
    const auto block = gradient_block<T>::of(c);
    const std::size_t weights = block.in_lanes * block.others, rows = tile_rows_of_band<T>(c, outputs),
                      bands = ceil_div(tiles.rows, rows),
                      transformed = block.in_lanes + block.others * block.vector_blocks();
    return tiles.elements() *
           (tiles.count() * (2 * weights + transform_cost(tiles.side) * transformed) + 2 * bands * weights);
}

}}} // namespace tactnet::kernels
