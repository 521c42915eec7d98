#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/panels/convolution.hpp>
#include <tactnet/kernels/panels/tiles.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

// Convolutions and dense layers whose maps or weights no near cache holds, of one frame or several, on one
// thread or several: by Winograd's tiles where these take fewer products, otherwise by panels. The bits of an
// output do not depend on the number of frames and threads.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Frames whose maps lie so many elements apart, and the share that one thread computes.
struct layerwise_job {
    std::size_t frames = 1, input_distance = 0, output_distance = 0;
    work_share share;
    std::size_t workspaces = 1; ///< how many workspaces of a plan the memory of the thread holds
};

/// The plan of such a convolution. Sizes only.
struct large_convolution {
    tile_plan tiles;
    panel_plan panels;

    constexpr explicit large_convolution(const frame_convolution& c) : tiles(c), panels(c) {}

    /// Whether filters fill whole vectors, and a pool only follows tiles.
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
    [[nodiscard]] constexpr std::size_t workspace() const {
        return pad_to_cache_line(tiled() ? tiles.workspace(tiles.band(tiles.count())) : panels.workspace());
    }
    /// The cost by the products that are computed, in the unit of frame_method.
    [[nodiscard]] constexpr std::uint64_t cost() const {
        const frame_convolution& c = tiles.convolution;
        return frame_method::product * (tiled() ? std::uint64_t{tiles.elements()} * tiles.count() *
                                                      c.window.input.channels * c.vectors()
                                                : c.vector_products());
    }
    /// `packed` must be zero-initialised. `weight(filter, channel, row, column)`.
    template <class Weight>
    constexpr void pack(const Weight& weight, float* packed) const {
        if (tiled())
            pack_tiles(tiles, weight, packed);
        else
            pack_panels(tiles.convolution, weight, packed);
    }
};

/// Computes the share of one thread of a convolution and its epilogue. `memory` is the workspace of that
/// thread.
template <class = void>
void convolve_large(const large_convolution& plan, const layerwise_job& job, const float* input,
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
        const std::size_t room = job.workspaces * plan.workspace() - plan.tiles.patch();
        const std::size_t band = std::min(plan.tiles.band(tiles), room / plan.tiles.workspace_of_tile());
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

/// A convolution that exceeds the near caches, by large_convolution.
template <frame_convolution C>
struct panel_method : frame_method {
    static constexpr const char* name = "panels";
    static constexpr large_convolution plan{C};
    /// Few channels and filters make products of tiles so short that the calls take as long as they do. The
    /// Winograd kernel of a frame, of constant sizes, took 0.54 to 0.87 of the time (Zen 4, 8 and 16 lanes).
    static constexpr bool short_products = plan.tiled() && C.window.input.channels <= 32 && C.filters <= 32;
    static constexpr bool applicable =
        large_convolution::fits(C) && C.exceeds_near_caches() && !short_products;
    static constexpr bool layerwise = true;
    static constexpr extent2d tile = plan.tiles.outputs;
    static constexpr std::uint64_t product_twentieths = plan.cost();
    static constexpr std::size_t packed_weights = pad_to_cache_line(plan.weights());
    static constexpr std::size_t packed_elements = packed_weights + pad_to_cache_line(C.padded_filters());
    static constexpr std::size_t workspace_elements = plan.workspace();

    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        plan.pack(weight, to);
        std::copy_n(biases, C.filters, to + packed_weights);
    }
    static void run(const float* packed, const float* in, float* out, float* workspace) noexcept {
        run_share(packed, in, out, workspace, {});
    }
    static void run_share(const float* packed, const float* in, float* out, float* workspace,
                          const layerwise_job& job) noexcept {
        convolve_large(plan, job, in, packed, packed + packed_weights, out, workspace);
    }
};

}}} // namespace tactnet::kernels
