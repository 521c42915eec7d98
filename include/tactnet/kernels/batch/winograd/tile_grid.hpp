#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/batch/direct_convolution.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

// Winograd convolution of one lane block, and its weight gradient: how a map is cut into tiles, and which
// tiles cost least. Both follow from the sizes alone, so that a network is trained to the same bits on all
// cores. simd/tile_lines.hpp has the transforms in one dimension.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A map cut into tiles of `outputs` outputs.
struct tile_grid {
    extent2d side;             ///< of an input tile, and of the transformed kernel
    std::size_t rows, columns; ///< tiles that cover the outputs

    [[nodiscard]] static constexpr tile_grid of(const batch_convolution& c, extent2d outputs) {
        return {{outputs.rows + c.kernel.rows - 1, outputs.columns + c.kernel.columns - 1},
                ceil_div(c.output.rows, outputs.rows),
                ceil_div(c.output.columns, outputs.columns)};
    }
    /// Elements of an input tile.
    [[nodiscard]] constexpr std::size_t elements() const { return side.area(); }
    [[nodiscard]] constexpr std::size_t count() const { return rows * columns; }
};

/// The packed elements before an output channel that begins a block.
template <batch_convolution C, class T>
[[nodiscard]] constexpr std::size_t tile_weights_before(std::size_t elements, std::size_t channel) {
    const std::size_t rest = channel % block_channels;
    return elements * (channel / block_channels * odd_lines<T>(C.input.channels * block_channels) +
                       (rest > 0 ? odd_lines<T>(C.input.channels * rest) : 0));
}

/// Whether tiles of `outputs` outputs can compute a convolution: there are transforms for them, stride and
/// spacing are 1, and the padding at the top and on the left is smaller than the kernel.
[[nodiscard]] constexpr bool winograd_possible(const batch_convolution& c, extent2d outputs) {
    const extent2d side = tile_grid::of(c, outputs).side;
    const auto less_than = [](std::ptrdiff_t padding, std::size_t kernel) {
        return padding >= 0 && static_cast<std::size_t>(padding) < kernel;
    };
    return c.groups == 1 && (c.kernel == extent2d(3) || c.kernel == extent2d(2)) && c.stride == extent2d(1) &&
           c.spacing == extent2d(1) && less_than(c.top, c.kernel.rows) &&
           less_than(c.left, c.kernel.columns) && std::min(outputs.rows, outputs.columns) >= 2 &&
           std::max(side.rows, side.columns) <= 6;
}

/// The cost of transforming one element of a tile of one channel or filter, in halves of a multiply-add.
/// Rounded from measured layers (benchmark_training_speed measures networks): an addition costs as much as a
/// product, and transforms with irrational points have more additions.
[[nodiscard]] constexpr std::size_t transform_cost(extent2d side) {
    return 8 + (side.rows > 4 ? 1 : 0) + (side.columns > 4 ? 1 : 0);
}

/// The cost of a convolution by tiles of `outputs` outputs, in halves of a multiply-add.
[[nodiscard]] constexpr std::size_t winograd_cost(const batch_convolution& c, extent2d outputs) {
    const tile_grid tiles = tile_grid::of(c, outputs);
    const std::size_t channels = c.input.channels, filters = c.output.channels;
    return tiles.elements() * tiles.count() *
           (2 * channels * filters + transform_cost(tiles.side) * (channels + filters));
}
/// The cheapest possible tile, or 0 if `direct` is cheaper. Errors grow with the tile: a larger one is chosen
/// only if it saves at least a twentieth of a smaller one, or of `direct`.
[[nodiscard]] constexpr extent2d cheapest_tile(const batch_convolution& c, std::size_t direct,
                                               bool (*possible)(const batch_convolution&, extent2d),
                                               std::size_t (*cost)(const batch_convolution&, extent2d)) {
    extent2d best = 0;
    std::size_t least = direct;
    for (std::size_t area = 4; area <= 25; ++area)
        for (std::size_t rows = 2; rows <= 5; ++rows) {
            const extent2d outputs(rows, area / rows);
            if (outputs.area() != area || !possible(c, outputs) || cost(c, outputs) * 21 >= least * 20)
                continue;
            best = outputs;
            least = cost(c, outputs);
        }
    return best;
}
[[nodiscard]] constexpr extent2d best_tile(const batch_convolution& c) {
    return winograd_possible(c, 2) ? cheapest_tile(c, direct_cost(c), winograd_possible, winograd_cost) : 0;
}

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
