#pragma once

#include <tactnet/kernels/panels/convolution.hpp>
#include <tactnet/kernels/panels/tiles.hpp>
#include <tactnet/runtime/work_share.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <cstddef>

// Convolutions and dense layers whose maps or weights no near cache holds, of one frame or several, alone or
// on several threads: by tiles where that takes fewer products, else by panels. What an output is does not
// depend on the frames and threads.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Frames whose maps lie so many elements apart, and the share of them that one thread computes.
struct large_job {
    std::size_t frames = 1, input_distance = 0, output_distance = 0;
    work_share share;
    std::size_t scratches = 1; ///< how many times the scratch of a plan the thread's memory holds
};

/// How such a convolution is computed. Sizes only.
struct large_convolution {
    /// Elements of both maps, or weights, from which on a convolution is taken for a large one. The networks
    /// for tactile images stay below both.
    static constexpr std::size_t fewest_elements = 40'000, fewest_weights = 256 * 1024;

    tile_plan tiles;
    panel_plan panels;

    constexpr explicit large_convolution(const frame_convolution& c) : tiles(c), panels(c) {}

    /// Whether a convolution can be computed so, and is large enough.
    [[nodiscard]] static constexpr bool suits(const frame_convolution& c) {
        const std::size_t elements = c.window.input.size() + c.rows() * c.columns() * c.filters;
        return fits(c) && (elements >= fewest_elements || c.weights() >= fewest_weights);
    }
    /// Whole vectors of filters, and a pool only behind tiles.
    [[nodiscard]] static constexpr bool fits(const frame_convolution& c) {
        return c.groups == 1 && c.fits_map() && c.width() == lanes<float> &&
               c.output_stride() % lanes<float> == 0 &&
               (c.pool == extent2d(1) ? c.pooled_rows == 0 : tile_plan(c).outputs > 0);
    }
    [[nodiscard]] constexpr bool tiled() const { return tiles.outputs > 0; }
    [[nodiscard]] constexpr std::size_t weights() const {
        return tiled() ? tiles.weights() : panels.weights();
    }
    /// Elements of memory for each thread or each frame, whichever are more.
    [[nodiscard]] constexpr std::size_t scratch() const {
        return whole_lines(tiled() ? tiles.scratch(tiles.band(tiles.count())) : panels.scratch());
    }
    /// Into zeros. `weight(filter, channel, row, column)`.
    template <class Weight>
    constexpr void pack(float* packed, Weight&& weight) const {
        if (tiled())
            pack_tiles(tiles, packed, weight);
        else
            pack_panels(tiles.convolution, packed, weight);
    }
};

/// output = convolution, bias, a sum, max pool, ReLU: the share of one thread. `memory` is the thread's own.
inline void convolve_large(const large_convolution& plan, const large_job& job, const float* input,
                           const float* weights, const float* bias, float* output, float* memory) {
    const filter_panels filters(plan.tiles.convolution.padded_filters());
    // Threads share what is larger: the weights, which then each reads in part, or the maps.
    const bool by_filters = plan.weights() > job.frames * plan.tiles.convolution.window.input.size() &&
                            filters.count >= job.share.threads;
    const std::size_t first_panel = by_filters ? job.share.begin(filters.count) : 0,
                      last_panel = by_filters ? job.share.end(filters.count) : filters.count;
    const auto begin = [&](std::size_t count) { return by_filters ? 0 : job.share.begin(count); };
    const auto end = [&](std::size_t count) { return by_filters ? count : job.share.end(count); };
    if (plan.tiled()) {
        const std::size_t tiles = plan.tiles.count() * job.frames;
        const std::size_t room = job.scratches * plan.scratch() - plan.tiles.patch();
        const std::size_t band = std::min(plan.tiles.band(tiles), room / plan.tiles.scratch_of_tile());
        convolve_tiles(plan.tiles, band, {begin(tiles), end(tiles), first_panel, last_panel},
                       {job.input_distance, job.output_distance}, input, weights, bias, output, memory);
        return;
    }
    panel_plan panels = plan.panels;
    const sliding_window& w = panels.convolution.window;
    std::size_t frames = job.frames;
    if (panels.flat() && job.input_distance == w.input.columns * panels.convolution.input_stride &&
        job.output_distance == w.input.columns * panels.convolution.output_stride()) {
        panels = panels.side_by_side(frames);
        frames = 1;
    }
    const std::size_t rows = w.output_rows(), columns = w.output_columns();
    // Pixels of a row are shared where there are not enough rows.
    const bool by_columns = rows * frames < job.share.threads;
    const std::size_t first_row = by_columns ? 0 : begin(rows * frames),
                      last_row = by_columns ? rows * frames : end(rows * frames);
    for (std::size_t row = first_row; row < last_row;) {
        const std::size_t frame = row / rows, last = std::min((frame + 1) * rows, last_row);
        convolve_panels(panels,
                        {row - frame * rows, last - frame * rows, by_columns ? begin(columns) : 0,
                         by_columns ? end(columns) : columns, first_panel, last_panel},
                        input + frame * job.input_distance, weights, bias,
                        output + frame * job.output_distance, memory);
        row = last;
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
