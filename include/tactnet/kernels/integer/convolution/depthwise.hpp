#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/convolution/depthwise_layout.hpp>
#include <tactnet/kernels/integer/interleave.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

// Depthwise convolution of one frame of bytes in integers: each filter sees one channel, and channels lie in
// lanes. Instructions that multiply a group of inputs at once take neighbours in a column: rows of the input
// are interleaved, so that a lane holds the pixels of as many rows. Of four such rows, a kernel of three rows
// with a zero below it computes one row of outputs, and with a zero above it the next.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// Interleaves the input rows under a band, from row `top` on, which counts the padding. Reads `Channels`
/// bytes per pixel.
template <class Layout, std::size_t Channels, frame_convolution C = Layout::convolution>
[[gnu::flatten, gnu::noinline]] void stage_band(const std::uint8_t* input, const std::uint8_t* padding,
                                                std::size_t top, std::size_t groups, std::uint8_t* to) {
    constexpr std::size_t group = Layout::group, block = Layout::block, columns = C.window.input.columns;
    using bytes = uint8_vec<block>;
    for (std::size_t g = 0; g < groups; ++g) {
        std::array<const std::uint8_t*, group> rows;
        std::array<std::size_t, group> steps;
        for (std::size_t r = 0; r < group; ++r) {
            const std::size_t row = top + g * group + r;
            const bool inside = row >= C.window.top && row - C.window.top < C.window.input.rows;
            rows[r] = inside ? input + (row - C.window.top) * columns * C.input_stride : padding;
            steps[r] = inside ? C.input_stride : 0;
        }
        const auto store = [&](const auto& pixel) __attribute__((always_inline)) {
            const auto row = [&](std::size_t r) __attribute__((always_inline)) {
                return pixel(r) ^ static_cast<std::uint8_t>(Layout::products::offset);
            };
            constexpr bytes none{};
            std::array<bytes, 4> vectors;
            if constexpr (group == 4)
                vectors = interleave<Layout::lanes>(row(0), row(1), row(2), row(3));
            else if constexpr (group == 2) // words, with zeros above the bytes
                vectors = interleave<Layout::lanes>(row(0), none, row(1), none);
            else
                vectors = interleave<Layout::lanes>(row(0), none, none, none);
#pragma GCC unroll 4
            for (std::size_t v = 0; v < 4; ++v, to += block)
                store_any(to, vectors[v]);
        };
        const auto pad = [&](std::size_t count) {
            for (std::size_t i = 0; i < count; ++i)
                store([&](std::size_t) { return load_first<block, Channels>(padding); });
        };
        constexpr std::size_t left = std::min(C.window.left, Layout::pitch),
                              last = std::clamp(C.window.left + columns, left, Layout::pitch);
        pad(left);
        for (std::size_t x = left; x < last; ++x)
            store([&](std::size_t r) {
                return load_first<block, Channels>(rows[r] + (x - C.window.left) * steps[r]);
            });
        pad(Layout::pitch - last);
    }
}

/// Computes one register block: `Rows` × `Columns` neighbouring outputs before pooling of a block of
/// channels, of which `Channels` are written. `Output` is a byte, or a float for sum × factor without
/// rounding.
template <class Layout, std::size_t Channels, std::size_t Rows, std::size_t Columns, class Output,
          frame_convolution C = Layout::convolution>
[[gnu::flatten, gnu::noinline]] void
convolve_depthwise_block(const std::uint8_t* staged, const std::int8_t* weights,
                         const integer_epilogue& epilogue, Output* output) {
    constexpr std::size_t lanes = Layout::lanes, block = Layout::block,
                          vectors = (std::min<std::size_t>(Channels, 16) + 3) / 4;
    constexpr std::size_t step = C.window.stride.columns,
                          under_columns = (Columns - 1) * step + C.window.kernel.columns,
                          groups = Layout::groups(Rows);
    constexpr std::size_t pooled_columns = ceil_div(Columns, C.pool.columns),
                          pixels = ceil_div(Rows, C.pool.rows) * pooled_columns;
    using sum = int32_vec<lanes>;
    const auto pixel = [&](std::size_t row, std::size_t column) __attribute__((always_inline)) {
        return output + (row * C.output_columns() + column) * C.output_stride();
    };
    std::array<std::array<sum, 4>, pixels> results{};
#pragma GCC unroll 4
    for (std::size_t v = 0; v < vectors; ++v) {
        std::array<sum, Rows * Columns> sums;
#pragma GCC unroll 64
        for (std::size_t p = 0; p < Rows * Columns; ++p) {
            sums[p] = epilogue.start<lanes>(v);
            if constexpr (C.accumulates) {
                constexpr uint8_vec<block> none{};
                const auto other = interleave<lanes>(
                    load_first<block, Channels>(pixel(p / Columns, p % Columns)), none, none, none);
                sums[p] += reinterpret_cast<sum>(other[v]) * epilogue.added_weight<lanes>(v);
            }
        }
#pragma GCC unroll 64
        for (std::size_t g = 0; g < groups; ++g)
#pragma GCC unroll 64
            for (std::size_t c = 0; c < under_columns; ++c) {
                const std::uint8_t* const inputs = staged + ((g * Layout::pitch + c) * 4 + v) * block;
#pragma GCC unroll 64
                for (std::size_t p = 0; p < Rows * Columns; ++p) {
                    const std::size_t row = p / Columns, first = p % Columns * step;
                    if (Layout::overlap(g, row) && c >= first && c - first < C.window.kernel.columns)
                        sums[p] = Layout::products::add(
                            sums[p],
                            weights +
                                (((g * Layout::band + row) * C.window.kernel.columns + c - first) * 4 + v) *
                                    block,
                            inputs);
                }
            }
#pragma GCC unroll 64
        for (std::size_t o = 0; o < pixels; ++o) {
            const std::size_t top = o / pooled_columns * C.pool.rows,
                              left = o % pooled_columns * C.pool.columns;
            const std::size_t high = std::min(C.pool.rows, Rows - top),
                              across = std::min(C.pool.columns, Columns - left);
            sum largest = sums[top * Columns + left];
#pragma GCC unroll 64
            for (std::size_t i = 1; i < high * across; ++i) {
                const sum& other = sums[(top + i / across) * Columns + left + i % across];
                largest = other > largest ? other : largest;
            }
            if constexpr (std::is_same_v<Output, std::uint8_t>)
                results[o][v] = rounded<lanes>(largest, epilogue.factor<lanes>(v), epilogue.range);
            else
                results[o][v] = reinterpret_cast<sum>(
                    epilogue.unrounded<lanes, C.rectifies()>(largest, epilogue.factor<lanes>(v)));
        }
    }
#pragma GCC unroll 64
    for (std::size_t o = 0; o < pixels; ++o) {
        Output* const to = pixel(o / pooled_columns, o % pooled_columns);
        if constexpr (std::is_same_v<Output, std::uint8_t>) {
            const auto bytes = instructions::narrow<lanes>(results[o]);
            std::memcpy(to, &bytes, Channels);
        } else {
            for (std::size_t c = 0; c < Channels; ++c)
                std::memcpy(to + c,
                            reinterpret_cast<const float*>(results[o].data()) + interleaved_place<lanes>(c),
                            sizeof(float));
        }
    }
}

} // namespace detail

/// The depthwise method with channels in lanes.
template <frame_convolution C, class Input>
struct depthwise_integer_method {
    using layout = depthwise_integer_layout<C>;
    static constexpr const char* name = "depthwise";
    static constexpr bool applicable = C.is_depthwise() && C.filters == C.groups &&
                                       std::is_same_v<Input, std::uint8_t> && max_integer_lanes > 1;
    static constexpr std::size_t vector_instructions =
        layout::band_cost(layout::band) * layout::blocks * ceil_div(C.rows(), layout::band);
    static constexpr std::size_t packed_elements = layout::blocks * layout::block_weights;
    /// A block of padding, then a staged band.
    static constexpr std::size_t workspace_elements = layout::block + layout::staged;
    static constexpr int offset = layout::products::offset;
    static constexpr std::size_t filter_places = layout::blocks * layout::block;
    static constexpr std::size_t place(std::size_t filter) { return layout::place(filter); }

    template <class Weight>
    static constexpr void pack(const Weight& weight, std::int8_t* to) {
        layout::pack(weight, to);
    }
    template <class Output>
    static void run(const std::int8_t* packed, const integer_epilogue& epilogue, const std::uint8_t* input,
                    Output* output, std::uint8_t* workspace) {
        std::uint8_t* const staged = workspace + layout::block;
        std::memset(workspace, epilogue.padding, layout::block);
        blocked<C.filters, layout::block>([&](auto channels, std::size_t first) {
            // The last block also writes the lanes after the last channel, and may read them.
            constexpr bool whole = channels == layout::block;
            constexpr std::size_t before = C.filters - channels,
                                  read = whole ? layout::block
                                               : std::min(layout::block, C.input_stride - before),
                                  written = whole ? layout::block : C.padded_filters() - before;
            const std::int8_t* const weights = packed + first / layout::block * layout::block_weights;
            const integer_epilogue here = epilogue.from(first);
            blocked<C.rows(), layout::band>([&](auto rows, std::size_t y) {
                detail::stage_band<layout, read>(input + first, workspace, y * C.window.stride.rows,
                                                 layout::groups(rows), staged);
                blocked<C.columns(), layout::block_columns>([&](auto columns, std::size_t x) {
                    detail::convolve_depthwise_block<layout, written, rows, columns>(
                        staged + x * C.window.stride.columns * 4 * layout::block, weights, here,
                        output +
                            (y / C.pool.rows * C.output_columns() + x / C.pool.columns) * C.output_stride() +
                            first);
                });
            });
        });
    }
};

}}} // namespace tactnet::kernels
