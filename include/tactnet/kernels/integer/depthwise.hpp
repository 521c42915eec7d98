#pragma once

#include <tactnet/detail/bits_as.hpp>
#include <tactnet/kernels/frame/convolution.hpp>
#include <tactnet/kernels/integer/byte_products.hpp>
#include <tactnet/kernels/integer/interleave.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

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

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

namespace detail {

/// Products of a group of inputs of each lane with the weights of that lane. Without an instruction for
/// groups: of one integer of 32 bits.
template <std::size_t Lanes, std::size_t Group = byte_products<Lanes>::group>
struct lane_products : byte_products<Lanes> {
    [[gnu::always_inline]] static int32_vec<Lanes>
    add(const int32_vec<Lanes>& sums, const std::int8_t* weights, const std::uint8_t* inputs) {
        using products = byte_products<Lanes>;
        return products::add(sums, load_any<typename products::weights>(weights),
                             load_any<typename products::inputs>(inputs));
    }
};
template <std::size_t Lanes>
struct lane_products<Lanes, 1> {
    using weight = std::int32_t;
    static constexpr std::size_t group = 1;
    static constexpr int offset = 0;
    [[gnu::always_inline]] static int32_vec<Lanes>
    add(const int32_vec<Lanes>& sums, const std::int8_t* weights, const std::uint8_t* inputs) {
        return sums + load_any<int32_vec<Lanes>>(weights) * load_any<int32_vec<Lanes>>(inputs);
    }
};

/// How a depthwise convolution is cut: blocks of four vectors of channels, bands of rows of outputs, register
/// blocks of columns.
template <frame_convolution C>
struct depthwise_layout {
    static constexpr frame_convolution convolution = C;
    /// Lanes of a vector: no more than fill four vectors, if that needs no more blocks.
    static constexpr std::size_t lanes = [] {
        const auto blocks = [](std::size_t l) { return (C.padded_filters() + 4 * l - 1) / (4 * l); };
        std::size_t l = max_integer_lanes;
        while (l > 4 && blocks(l / 2) == blocks(max_integer_lanes))
            l /= 2;
        return l;
    }();
    static constexpr std::size_t block = 4 * lanes, ///< channels, and bytes of a vector
        blocks = (C.padded_filters() + block - 1) / block;
    using products = lane_products<lanes>;
    static constexpr std::size_t group = products::group;

    /// Rows of the input under so many rows of outputs, and groups of them.
    static constexpr std::size_t under(std::size_t rows) {
        return (rows - 1) * C.window.stride.rows + C.window.kernel.rows;
    }
    static constexpr std::size_t groups(std::size_t rows) { return (under(rows) + group - 1) / group; }
    /// Whether a group has rows under a row of outputs.
    static constexpr bool overlap(std::size_t in_group, std::size_t row) {
        const std::size_t first = row * C.window.stride.rows;
        return in_group * group < first + C.window.kernel.rows && (in_group + 1) * group > first;
    }
    /// Columns of the input under all outputs.
    static constexpr std::size_t pitch =
        (C.columns() - 1) * C.window.stride.columns + C.window.kernel.columns;
    /// Instructions on vectors for a band of a full block: loads, shuffles and stores of the rows, products.
    static constexpr std::size_t band_cost(std::size_t rows) {
        std::size_t overlaps = 0;
        for (std::size_t g = 0; g < groups(rows); ++g)
            for (std::size_t y = 0; y < rows; ++y)
                overlaps += overlap(g, y) ? 1 : 0;
        return 16 * groups(rows) * pitch +
               4 * (group == 4 ? 1 : 2) * overlaps * C.window.kernel.columns * C.columns();
    }
    static constexpr std::size_t band = [] {
        const std::size_t most =
            std::min(std::max<std::size_t>(vector_registers == 32 ? 4 : 2, C.pool.rows), C.rows());
        std::size_t best = std::min(C.pool.rows, C.rows());
        for (std::size_t rows = best; rows <= most; rows += C.pool.rows)
            if (band_cost(rows) * best < band_cost(best) * rows)
                best = rows;
        return best;
    }();
    /// Columns of a register block.
    static constexpr std::size_t block_columns = [] {
        const std::size_t step = C.pool.columns, sums = vector_registers == 32 ? 8 : 4;
        const std::size_t most = std::max(sums / band / step * step, step);
        const std::size_t count = (C.columns() + most - 1) / most, even = (C.columns() + count - 1) / count;
        return (even + step - 1) / step * step;
    }();
    /// Bytes of the weights of a block: [group][row of the band][kernel column][vector][lane][input].
    static constexpr std::size_t block_weights = groups(band) * band * C.window.kernel.columns * 4 * block;
    /// Bytes of a band of a block: [group][column][vector][lane][input].
    static constexpr std::size_t staged = groups(band) * pitch * 4 * block;
};

/// Interleaves the rows under a band, of which the first is `top`, counted with the padding. `Channels` are
/// read of each pixel.
template <class Layout, std::size_t Channels>
[[gnu::flatten, gnu::noinline]] void stage_band(const std::uint8_t* input, const std::uint8_t* padding,
                                                std::size_t top, std::size_t groups, std::uint8_t* to) {
    constexpr frame_convolution C = Layout::convolution;
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
template <class Layout, std::size_t Channels, std::size_t Rows, std::size_t Columns, class Output>
[[gnu::flatten, gnu::noinline]] void
convolve_depthwise_block(const std::uint8_t* staged, const std::int8_t* weights,
                         const integer_epilogue& epilogue, Output* output) {
    constexpr frame_convolution C = Layout::convolution;
    constexpr std::size_t lanes = Layout::lanes, block = Layout::block,
                          vectors = (std::min<std::size_t>(Channels, 16) + 3) / 4;
    constexpr std::size_t step = C.window.stride.columns,
                          under_columns = (Columns - 1) * step + C.window.kernel.columns,
                          groups = Layout::groups(Rows);
    constexpr std::size_t pooled_columns = (Columns + C.pool.columns - 1) / C.pool.columns,
                          pixels = (Rows + C.pool.rows - 1) / C.pool.rows * pooled_columns;
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
            if constexpr (C.adds) {
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
                results[o][v] = reinterpret_cast<sum>(epilogue.unrounded<lanes, C.rectified>(largest, v));
        }
    }
#pragma GCC unroll 64
    for (std::size_t o = 0; o < pixels; ++o) {
        Output* const to = pixel(o / pooled_columns, o % pooled_columns);
        if constexpr (std::is_same_v<Output, std::uint8_t>) {
            const auto bytes = narrow<lanes>(results[o]);
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
    using layout = detail::depthwise_layout<C>;
    static constexpr const char* name = "depthwise";
    static constexpr bool applicable =
        C.is_depthwise() && std::is_same_v<Input, std::uint8_t> && max_integer_lanes > 1;
    static constexpr std::size_t cost =
        layout::band_cost(layout::band) * layout::blocks * ((C.rows() + layout::band - 1) / layout::band);
    static constexpr std::size_t packed_elements = layout::blocks * layout::block_weights;
    /// Zeros of the input that a pixel outside has, then a staged band.
    static constexpr std::size_t workspace_elements = layout::block + layout::staged;
    static constexpr int offset = layout::products::offset;
    static constexpr std::size_t filter_places = layout::blocks * layout::block;
    static constexpr std::size_t place(std::size_t filter) {
        return filter / layout::block * layout::block +
               interleaved_place<layout::lanes>(filter % layout::block);
    }

    template <class Weight>
    static constexpr void pack(std::int8_t* packed, const Weight& weight_at) {
        using weight = typename layout::products::weight;
        for (std::size_t i = 0; i < layout::block_weights / sizeof(weight) * layout::blocks; ++i) {
            // Which weight that is.
            std::size_t rest = i;
            const auto next = [&rest](std::size_t count) {
                const std::size_t index = rest % count;
                rest /= count;
                return index;
            };
            const std::size_t input = next(layout::group), lane = next(layout::lanes), vector = next(4),
                              column = next(C.window.kernel.columns), y = next(layout::band),
                              group = next(layout::groups(layout::band)),
                              filter = rest * layout::block + lane / 4 * 16 + vector * 4 + lane % 4,
                              row =
                                  group * layout::group + input - y * C.window.stride.rows; // may wrap around
            const bool there = filter < C.filters && row < C.window.kernel.rows;
            const auto bytes = tactnet::detail::bits_as<std::array<std::int8_t, sizeof(weight)>>(
                weight{there ? weight_at(filter, std::size_t{0}, row, column) : std::int8_t{0}});
            packed = std::copy(bytes.begin(), bytes.end(), packed);
        }
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

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
