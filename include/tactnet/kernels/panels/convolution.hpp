#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/panels/product.hpp>

#include <algorithm>
#include <cstddef>

// Convolution of maps that no near cache holds: a product of the inputs under the taps and panels of filters
// (product.hpp). Taps are cut into parts, so that a panel and its rows stay in cache: all filters use one
// part of some outputs before the next is loaded. If an image has neither padding nor gaps that matter, its
// inputs are read in place, without a copy.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A convolution cut into bands of outputs and parts of taps. Sizes only.
struct panel_plan {
    /// Limits on the taps of a part (a panel of four vectors of 16 filters then has 32 kB), the outputs of a
    /// band, and the elements of their inputs.
    static constexpr std::size_t max_taps = 128, max_pixels = 224, fewest_pixels = 56,
                                 max_inputs = l2_cache_bytes / 2 / sizeof(float);
    /// Rows that lie a multiple of so many elements apart share the same sets of a cache.
    static constexpr std::size_t clashing = 1024;

    /// With an image of one row if each pixel stands for itself, of one pixel if the kernel covers all
    /// pixels.
    frame_convolution convolution;
    bool staged;               ///< whether the input is copied, with its padding around it
    std::size_t stride;        ///< elements from one pixel to the next of the copy, or of the input
    bool joined;               ///< whether the taps of a kernel row lie side by side
    std::size_t line_taps;     ///< taps that lie side by side: of a kernel row, or the channels of one tap
    std::size_t parts_of_line; ///< more than one if lines are long
    std::size_t lines_of_part; ///< more than one if lines are short
    std::size_t band_rows, band_columns; ///< outputs that are computed for all filters before the next

    constexpr explicit panel_plan(const frame_convolution& as_given) : convolution(as_given) {
        sliding_window& w = convolution.window;
        const auto reach = [](std::size_t outputs, std::size_t step, std::size_t kernel) {
            return (outputs - 1) * step + kernel;
        };
        const bool padded = w.top + w.left > 0 ||
                            reach(w.output_rows(), w.stride.rows, w.kernel.rows) > w.input.rows ||
                            reach(w.output_columns(), w.stride.columns, w.kernel.columns) > w.input.columns;
        if (!padded && convolution.input_stride == w.input.channels &&
            w.kernel == extent2d(w.input.rows, w.input.columns)) {
            w = {{1, 1, w.input.size()}, 1, 1};
            convolution.input_stride = w.input.channels;
        } else if (!padded && w.kernel == extent2d(1) && w.stride == extent2d(1)) {
            w = {{1, w.input.area(), w.input.channels}, 1, 1};
        }
        const bool one_pixel = w.input.area() == 1;
        staged = padded || (w.stride.columns * convolution.input_stride % clashing == 0 && !one_pixel);
        const bool clashes = w.stride.columns * w.input.channels % clashing == 0 && !one_pixel;
        stride = !staged ? convolution.input_stride : w.input.channels + (clashes ? 16 : 0);
        joined = stride == w.input.channels;
        line_taps = joined ? w.kernel.columns * w.input.channels : w.input.channels;
        parts_of_line = ceil_div(line_taps, max_taps);
        lines_of_part =
            std::clamp<std::size_t>(max_taps / line_taps, 1, joined ? w.kernel.rows : w.kernel.columns);
        cut_bands();
    }
    /// Several images side by side, which must be flat(): a band holds pixels of as many images as stay in
    /// cache, and weights are read once for all of them.
    [[nodiscard]] constexpr panel_plan side_by_side(std::size_t images) const {
        panel_plan longer = *this;
        longer.convolution.window.input.columns *= images;
        longer.cut_bands();
        return longer;
    }
    /// Whether the image is one row of pixels without a neighbourhood, so that several images make a longer
    /// row.
    [[nodiscard]] constexpr bool flat() const {
        return convolution.window.kernel == extent2d(1) && convolution.window.input.rows == 1 &&
               convolution.window.stride == extent2d(1);
    }
    /// Pixels of the input under a band.
    [[nodiscard]] constexpr extent2d under(std::size_t rows, std::size_t columns) const {
        const sliding_window& w = convolution.window;
        return {(rows - 1) * w.stride.rows + w.kernel.rows,
                (columns - 1) * w.stride.columns + w.kernel.columns};
    }
    /// Elements of workspace for one thread.
    [[nodiscard]] constexpr std::size_t workspace() const {
        return staged ? under(band_rows, flat() ? max_pixels : band_columns).area() * stride : 0;
    }
    [[nodiscard]] constexpr std::size_t weights() const { return convolution.weights(); }

    /// Some taps that are added in registers.
    struct part {
        std::size_t first;                ///< tap, in the order of the weights
        std::size_t lines, depth;         ///< so many lines, of each so many taps
        std::size_t row, column, channel; ///< of the first tap
    };
    /// Calls body(part) for all parts in order.
    template <class Body>
    constexpr void for_each_part(Body&& body) const {
        const extent2d kernel = convolution.window.kernel;
        const std::size_t rows = joined ? 1 : kernel.rows, lines = joined ? kernel.rows : kernel.columns;
        std::size_t first = 0;
        for (std::size_t row = 0; row < rows; ++row)
            for (std::size_t line = 0; line < lines; line += lines_of_part)
                for (std::size_t piece = 0; piece < parts_of_line; ++piece) {
                    const std::size_t begin = line_taps * piece / parts_of_line,
                                      end = line_taps * (piece + 1) / parts_of_line;
                    const part some{.first = first,
                                    .lines = std::min(lines_of_part, lines - line),
                                    .depth = end - begin,
                                    .row = joined ? line : row,
                                    .column = joined ? 0 : line,
                                    .channel = begin};
                    body(some);
                    first += some.lines * some.depth;
                }
    }

private:
    /// As many outputs as stay in cache, in bands of nearly the same size.
    constexpr void cut_bands() {
        const sliding_window& w = convolution.window;
        const std::size_t pixels =
            std::clamp(max_inputs / (stride * w.stride.area()), fewest_pixels, max_pixels);
        const std::size_t bands = ceil_div(w.output_columns(), pixels);
        band_columns = ceil_div(w.output_columns(), bands);
        band_rows = std::clamp<std::size_t>(pixels / band_columns, 1, w.output_rows());
    }
};

/// Weights in the order of use: [part of the taps][panel][tap][filter of the panel]; taps as [kernel row]
/// [kernel column][channel], zeros where there is no filter. `weight(filter, channel, row, column)`.
template <class Weight>
constexpr void pack_panels(const frame_convolution& c, const Weight& weight, float* packed) {
    const std::size_t columns = c.window.kernel.columns, channels = c.window.input.channels;
    const filter_panels panels(c.padded_filters());
    panel_plan(c).for_each_part([&](const panel_plan::part& part) {
        for (std::size_t panel = 0; panel < panels.count; ++panel)
            for (std::size_t tap = part.first; tap < part.first + part.lines * part.depth; ++tap)
                for (std::size_t f = panels.begin(panel); f < panels.begin(panel + 1); ++f)
                    *packed++ = f < c.filters ? weight(f, tap % channels, tap / channels / columns,
                                                       tap / channels % columns)
                                              : 0.0f;
    });
}

/// Some of the outputs of a convolution: pixels of the plan's image, and panels of filters.
struct panel_share {
    std::size_t first_row, last_row, first_column, last_column, first_panel, last_panel;
};

/// output = bias + convolution, a sum, activation function; no pool. `memory` holds plan.workspace()
/// elements.
template <class = void>
void convolve_panels(const panel_plan& plan, const panel_share& share, const float* input,
                     const float* weights, const float* bias, float* output, float* memory) {
    const frame_convolution& c = plan.convolution;
    const sliding_window& w = c.window;
    const filter_panels panels(c.padded_filters());
    const std::size_t out_columns = w.output_columns(), taps = c.taps();
    for (std::size_t y = share.first_row; y < share.last_row; y += plan.band_rows)
        for (std::size_t x = share.first_column; x < share.last_column; x += plan.band_columns) {
            const std::size_t rows = std::min(plan.band_rows, share.last_row - y),
                              columns = std::min(plan.band_columns, share.last_column - x);
            const std::size_t top = y * w.stride.rows, left = x * w.stride.columns;
            const float* from = input + (top * w.input.columns + left) * c.input_stride;
            std::size_t row_distance = w.input.columns * c.input_stride;
            if (plan.staged) {
                const extent2d size = plan.under(rows, columns);
                stage_map(w, c.input_stride, input, top, left, size, plan.stride, memory);
                from = memory, row_distance = size.columns * plan.stride;
            }
            plan.for_each_part([&](const panel_plan::part& part) {
                const float* const at =
                    from + part.row * row_distance + part.column * plan.stride + part.channel;
                const epilogue end{.bias = part.first == 0 ? bias : nullptr,
                                   .accumulates = part.first > 0 || c.accumulates,
                                   .rectifies =
                                       c.rectifies() && part.first + part.lines * part.depth == taps};
                for (std::size_t panel = share.first_panel; panel < share.last_panel; ++panel)
                    for (std::size_t r = 0; r < rows; ++r) {
                        const bool one = rows * columns == 1; // a single row takes all panels
                        multiply_panels({.input = at + r * w.stride.rows * row_distance,
                                         .input_stride = w.stride.columns * plan.stride,
                                         .lines = part.lines,
                                         .depth = part.depth,
                                         .line_distance = plan.joined ? row_distance : plan.stride,
                                         .output = output + ((y + r) * out_columns + x) * c.output_stride(),
                                         .output_stride = c.output_stride()},
                                        columns, panels, panel, one ? share.last_panel : panel + 1,
                                        weights + part.first * c.padded_filters(), end);
                        if (one)
                            panel = share.last_panel;
                    }
            });
            if (c.activation->exists && !c.rectifies()) {
                const std::size_t first = panels.begin(share.first_panel);
                c.activation->apply({output + (y * out_columns + x) * c.output_stride() + first, rows,
                                     out_columns * c.output_stride(), columns, c.output_stride(),
                                     panels.begin(share.last_panel) - first});
            }
        }
}

}}} // namespace tactnet::kernels
