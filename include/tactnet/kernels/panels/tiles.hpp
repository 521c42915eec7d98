#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/panels/product.hpp>
#include <tactnet/kernels/panels/tile_transforms.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Winograd convolutions of maps that no near cache holds: for each element of the transformed tiles, a
// product of tiles and panels of filters (product.hpp).

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A convolution cut into tiles. Sizes only.
struct tile_plan {
    /// The most channels that are added in registers.
    static constexpr std::size_t max_depth = 128;
    /// The fewest tiles that are worth reading transformed weights: a few register blocks.
    static constexpr std::size_t fewest_tiles = 12;

    frame_convolution convolution;
    std::size_t outputs; ///< rows and columns of a tile of outputs, 2 or 4; 0: not by tiles

    constexpr explicit tile_plan(const frame_convolution& c) : convolution(c), outputs(0) {
        const bool possible =
            c.window.kernel == extent2d(3) && c.window.stride == extent2d(1) &&
            (c.pool == extent2d(1) || c.pool == extent2d(2)) && c.window.input.channels % lanes<float> == 0 &&
            c.input_stride % lanes<float> == 0 && c.input_offset_multiple % lanes<float> == 0;
        if (!possible)
            return;
        // In products: F(4 × 4) reads more weights, so it must save a third of those of F(2 × 2). Either must
        // use its weights often enough, and save a fifth of the products of taps.
        const std::size_t by_2 = 16 * tiles(2), by_4 = 36 * tiles(4), by_taps = c.window.taps_on_pixels();
        if (tiles(4) >= fewest_tiles && by_4 * 3 <= by_2 * 2 && by_4 * 5 <= by_taps * 4)
            outputs = 4;
        else if (tiles(2) >= fewest_tiles && by_2 * 5 <= by_taps * 4)
            outputs = 2;
    }
    [[nodiscard]] constexpr std::size_t side() const { return outputs + 2; }
    [[nodiscard]] constexpr std::size_t elements() const { return side() * side(); }
    [[nodiscard]] constexpr std::size_t columns() const { return ceil_div(convolution.columns(), outputs); }
    /// Tiles of one frame.
    [[nodiscard]] constexpr std::size_t count() const { return tiles(outputs); }

    [[nodiscard]] constexpr std::size_t channels() const { return convolution.window.input.channels; }
    /// Elements from one transformed tile to the next: a distance with which tiles do not share sets of a
    /// cache.
    [[nodiscard]] constexpr std::size_t tile_stride() const {
        return channels() + (channels() % 512 == 0 ? pad_to_cache_line(lanes<float>) : 0);
    }
    [[nodiscard]] constexpr std::size_t product_stride() const { return convolution.padded_filters(); }
    /// Tiles of a band, which passes all transforms before the next begins: about as many as make the maps as
    /// large as the weights, which each band reads.
    [[nodiscard]] constexpr std::size_t band(std::size_t tiles_of_all) const {
        const std::size_t most =
            std::max(channels() * convolution.padded_filters() / (channels() + convolution.padded_filters()),
                     std::size_t{28});
        const std::size_t bands = ceil_div(tiles_of_all, most);
        return ceil_div(tiles_of_all, bands);
    }
    /// The number of parts into which the channels are cut.
    [[nodiscard]] constexpr std::size_t parts() const { return ceil_div(channels(), max_depth); }
    [[nodiscard]] constexpr std::size_t part_begin(std::size_t part) const {
        return channels() * part / parts();
    }
    [[nodiscard]] constexpr std::size_t weights() const {
        return elements() * channels() * convolution.padded_filters();
    }
    [[nodiscard]] constexpr std::size_t patch() const { return elements() * channels(); }
    /// Elements of workspace that one thread needs for bands of so many tiles.
    [[nodiscard]] constexpr std::size_t workspace(std::size_t band_tiles) const {
        return patch() + band_tiles * workspace_of_tile();
    }

    [[nodiscard]] constexpr std::size_t workspace_of_tile() const {
        return elements() * (tile_stride() + product_stride());
    }

private:
    [[nodiscard]] constexpr std::size_t tiles(std::size_t size) const {
        return ceil_div(convolution.rows(), size) * ceil_div(convolution.columns(), size);
    }
};

/// Kernels as G g Gᵀ in the order of use: [element][part of the channels][panel][channel][filter of the
/// panel]; zeros where there is no filter. `weight(filter, channel, row, column)`.
template <std::size_t Outputs, class Weight>
constexpr void pack_tiles_of(const tile_plan& plan, const Weight& weight, float* packed) {
    constexpr std::size_t side = Outputs + 2;
    const frame_convolution& c = plan.convolution;
    const filter_panels panels(c.padded_filters());
    for (std::size_t part = 0; part < plan.parts(); ++part) {
        const std::size_t begin = plan.part_begin(part), end = plan.part_begin(part + 1);
        for (std::size_t panel = 0; panel < panels.count; ++panel) {
            const std::size_t first = panels.begin(panel), last = panels.begin(panel + 1);
            for (std::size_t channel = begin; channel < end; ++channel)
                for (std::size_t f = first; f < std::min(last, c.filters); ++f) {
                    std::array<std::array<double, 3>, side> half{};
                    for (std::size_t column = 0; column < 3; ++column) {
                        const std::array<double, 3> g{static_cast<double>(weight(f, channel, 0, column)),
                                                      static_cast<double>(weight(f, channel, 1, column)),
                                                      static_cast<double>(weight(f, channel, 2, column))};
                        const std::array<double, side> line = detail::tile_kernel_line<side>(g);
                        for (std::size_t l = 0; l < side; ++l)
                            half[l][column] = line[l];
                    }
                    float* const to = packed + begin * c.padded_filters() + (end - begin) * first +
                                      (channel - begin) * (last - first) + f - first;
                    for (std::size_t row = 0; row < side; ++row) {
                        const std::array<double, side> line = detail::tile_kernel_line<side>(half[row]);
                        for (std::size_t column = 0; column < side; ++column)
                            to[(row * side + column) * plan.channels() * c.padded_filters()] =
                                static_cast<float>(line[column]);
                    }
                }
        }
    }
}
/// `packed` must be zero-initialised.
template <class Weight>
constexpr void pack_tiles(const tile_plan& plan, const Weight& weight, float* packed) {
    if (plan.outputs == 2)
        pack_tiles_of<2>(plan, weight, packed);
    else
        pack_tiles_of<4>(plan, weight, packed);
}

/// A share of a convolution: tiles, counted over all frames, and panels of filters.
struct tile_share {
    std::size_t first_tile, last_tile, first_panel, last_panel;
};

/// Frames whose maps lie so many elements apart.
struct frame_distances {
    std::size_t input, output;
};

/// Applies an activation function to the stored outputs of `count` tiles from tile `first` on, in runs of
/// tiles side by side, of the filters [first_filter, last_filter).
inline void activate_tiles(const tile_plan& plan, std::size_t outputs, std::size_t first, std::size_t count,
                           std::size_t first_filter, std::size_t last_filter, std::size_t distance,
                           float* output) {
    const frame_convolution& c = plan.convolution;
    for (const std::size_t end = first + count; first < end;) {
        const std::size_t tile = first % plan.count(), column = tile % plan.columns(),
                          run = std::min(plan.columns() - column, end - first),
                          y = tile / plan.columns() * outputs, x = column * outputs;
        const std::size_t rows = ceil_div(std::min(outputs, c.rows() - y), c.pool.rows),
                          columns = ceil_div(std::min(run * outputs, c.columns() - x), c.pool.columns);
        c.activation->apply(
            {output + first / plan.count() * distance +
                 (y / c.pool.rows * c.output_columns() + x / c.pool.columns) * c.output_stride() +
                 first_filter,
             rows, c.output_columns() * c.output_stride(), columns, c.output_stride(),
             last_filter - first_filter});
        first += run;
    }
}

/// Computes a share of the convolution and its epilogue. `memory` holds plan.workspace(band) elements.
template <std::size_t Outputs>
void convolve_tiles_of(const tile_plan& plan, std::size_t band, const tile_share& share,
                       const frame_distances& distances, const float* input, const float* weights,
                       const float* bias, float* output, float* memory) {
    constexpr std::size_t side = Outputs + 2, elements = side * side;
    const frame_convolution& c = plan.convolution;
    const sliding_window& w = c.window;
    const std::size_t channels = plan.channels(), filters = c.padded_filters();
    const filter_panels panels(filters);
    const bool pooled = c.pool == extent2d(2);
    float* const transformed = memory + plan.patch();
    const std::size_t input_distance = band * plan.tile_stride(),
                      product_distance = band * plan.product_stride();
    float* const products = transformed + elements * input_distance;
    for (std::size_t first = share.first_tile; first < share.last_tile; first += band) {
        const std::size_t count = std::min(band, share.last_tile - first);
        // body(tile of the band, frame, row and column of its first output)
        const auto for_each_tile = [&](auto&& body) {
            for (std::size_t t = 0; t < count; ++t) {
                const std::size_t tile = (first + t) % plan.count();
                body(t, (first + t) / plan.count(), tile / plan.columns() * Outputs,
                     tile % plan.columns() * Outputs);
            }
        };
        for_each_tile([&](std::size_t t, std::size_t frame, std::size_t y, std::size_t x) {
            const float* const map = input + frame * distances.input;
            float* const to = transformed + t * plan.tile_stride();
            if (y >= w.top && x >= w.left && y + side <= w.top + w.input.rows &&
                x + side <= w.left + w.input.columns) {
                transform_tile<Outputs>(map + ((y - w.top) * w.input.columns + x - w.left) * c.input_stride,
                                        w.input.columns * c.input_stride, c.input_stride, channels, to,
                                        input_distance);
            } else {
                stage_map(w, c.input_stride, map, y, x, side, channels, memory);
                transform_tile<Outputs>(memory, side * channels, channels, channels, to, input_distance);
            }
        });
        for (std::size_t e = 0; e < elements; ++e)
            for (std::size_t part = 0; part < plan.parts(); ++part) {
                const std::size_t begin = plan.part_begin(part), depth = plan.part_begin(part + 1) - begin;
                multiply_panels({.input = transformed + e * input_distance + begin,
                                 .input_stride = plan.tile_stride(),
                                 .lines = 1,
                                 .depth = depth,
                                 .line_distance = depth,
                                 .output = products + e * product_distance,
                                 .output_stride = plan.product_stride()},
                                count, panels, share.first_panel, share.last_panel,
                                weights + (e * channels + begin) * filters, {.accumulates = part > 0});
            }
        for_each_tile([&](std::size_t t, std::size_t frame, std::size_t y, std::size_t x) {
            const std::size_t row = pooled ? y / 2 : y, column = pooled ? x / 2 : x;
            transform_tile_back<Outputs>(
                products + t * plan.product_stride(), product_distance, bias, panels.begin(share.first_panel),
                panels.begin(share.last_panel),
                {.output = output + frame * distances.output +
                           (row * c.output_columns() + column) * c.output_stride(),
                 .row_distance = c.output_columns() * c.output_stride(),
                 .pixel_distance = c.output_stride(),
                 .size = {std::min(Outputs, c.rows() - y), std::min(Outputs, c.columns() - x)},
                 .accumulates = c.accumulates,
                 .rectifies = c.rectifies(),
                 .pooled = pooled});
        });
        if (c.activation->exists && !c.rectifies())
            activate_tiles(plan, Outputs, first, count, panels.begin(share.first_panel),
                           panels.begin(share.last_panel), distances.output, output);
    }
}

template <class = void>
void convolve_tiles(const tile_plan& plan, std::size_t band, const tile_share& share,
                    const frame_distances& distances, const float* input, const float* weights,
                    const float* bias, float* output, float* memory) {
    if (plan.outputs == 2)
        convolve_tiles_of<2>(plan, band, share, distances, input, weights, bias, output, memory);
    else
        convolve_tiles_of<4>(plan, band, share, distances, input, weights, bias, output, memory);
}

}}} // namespace tactnet::kernels
