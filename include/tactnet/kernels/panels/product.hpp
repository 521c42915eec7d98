#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Copies a piece of a map with the padding around it.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// Copies whole vectors; the last overlaps its neighbour.
template <class Vector, std::size_t Lanes>
[[gnu::always_inline]] inline void copy_vectors(const float* from, float* to, std::size_t count) {
    std::size_t i = 0;
    for (; i + Lanes <= count; i += Lanes)
        store_anywhere(to + i, load_unaligned<Vector>(from + i));
    if (i < count)
        store_anywhere(to + count - Lanes, load_unaligned<Vector>(from + count - Lanes));
}
inline void copy_line(const float* from, float* to, std::size_t count) {
    if (count >= lanes<float>)
        copy_vectors<vector<float>, lanes<float>>(from, to, count);
    else if (count >= min_lanes<float>)
        copy_vectors<sized_vector<float, min_lanes<float>>, min_lanes<float>>(from, to, count);
    else
        std::copy_n(from, count, to);
}

} // namespace detail

/// `size` pixels from `top` and `left` on, counted with the padding, which is zero. Pixels of the map are
/// `input_stride` elements apart, those of the copy `stride`, without gaps between its rows.
inline void stage_map(const sliding_window& w, std::size_t input_stride, const float* input, std::size_t top,
                      std::size_t left, extent2d size, std::size_t stride, float* to) {
    const std::size_t channels = w.input.channels;
    const auto kept = [](std::size_t at, std::size_t before, std::size_t first, std::size_t count) {
        return at > before + first ? std::min(at - before - first, count) : 0;
    };
    // The first column of the copy on the image, and the end of these columns.
    const std::size_t begin = w.left > left ? std::min(w.left - left, size.columns) : 0,
                      end = std::max(begin, kept(w.left + w.input.columns, 0, left, size.columns));
    for (std::size_t r = 0; r < size.rows; ++r, to += size.columns * stride) {
        const std::size_t row = top + r;
        if (row < w.top || row >= w.top + w.input.rows) {
            std::fill_n(to, size.columns * stride, 0.0f);
            continue;
        }
        std::fill_n(to, begin * stride, 0.0f);
        std::fill_n(to + end * stride, (size.columns - end) * stride, 0.0f);
        const float* const from =
            input + ((row - w.top) * w.input.columns + left + begin - w.left) * input_stride;
        if (stride == channels && input_stride == channels)
            detail::copy_line(from, to + begin * stride, (end - begin) * channels);
        else
            for (std::size_t column = begin; column < end; ++column)
                detail::copy_line(from + (column - begin) * input_stride, to + column * stride, channels);
    }
}

// Products of rows and panels of weights, for the convolutions and dense layers of large networks and for A ·
// Bᵀ (rows/packed.hpp). A panel holds the weights of a few vectors of filters, [input][filter]. Sizes are
// run-time arguments, so all layers share these few functions. Each output is one chain of multiply-adds in
// the order of the inputs, whichever rows are computed with it.

/// The most vectors of filters in a panel: the more, the fewer inputs are read.
inline constexpr std::size_t max_panel_vectors = vector_registers >= 32 ? 4 : 2;
/// The most rows of a register block: they leave registers for the weights and one input.
[[nodiscard]] constexpr std::size_t max_panel_rows(std::size_t vectors) {
    constexpr std::size_t most = vector_registers >= 32 ? 14 : 12;
    return std::min((vector_registers - 1 - vectors) / vectors, most);
}

/// Filters cut into panels of nearly the same number of vectors.
struct filter_panels {
    std::size_t vectors, count;

    constexpr explicit filter_panels(std::size_t padded_filters)
        : vectors(padded_filters / lanes<float>), count(ceil_div(vectors, max_panel_vectors)) {}
    /// The first vector of a panel, and the first filter.
    [[nodiscard]] constexpr std::size_t vector(std::size_t panel) const { return vectors * panel / count; }
    [[nodiscard]] constexpr std::size_t begin(std::size_t panel) const {
        return vector(panel) * lanes<float>;
    }
    /// Vectors of a panel.
    [[nodiscard]] constexpr std::size_t size(std::size_t panel) const {
        return vector(panel + 1) - vector(panel);
    }
};

/// The epilogue applied to the sums of a product.
struct epilogue {
    const float* bias =
        nullptr;              ///< of the filters of the panel; null for the second and later parts of a sum
    bool accumulates = false; ///< whether the output accumulates
    bool rectifies = false;   ///< whether a ReLU follows
};

/// The rows of a product, in and out. A row of inputs is `lines` pieces of `depth` inputs each.
struct panel_rows {
    const float* input;
    std::size_t input_stride; ///< elements from one row to the next
    std::size_t lines, depth;
    std::size_t line_distance; ///< elements from one line to the next
    float* output;             ///< aligned
    std::size_t output_stride;
};

/// How far ahead weights are prefetched, in elements: it covers the latency of memory within a page or two.
inline constexpr std::size_t prefetch_distance = 8192 / sizeof(float);

/// `Rows` rows times `Panels` panels of `Vectors` vectors of filters, `panel_distance` elements apart in the
/// weights, side by side in the output. A single row multiplies several panels, since one panel would wait
/// for memory.
template <std::size_t Rows, std::size_t Vectors, std::size_t Panels = 1>
[[gnu::flatten, gnu::noinline]] void multiply_panel(const panel_rows& rows, const float* panel,
                                                    std::size_t panel_distance, epilogue end) {
    using wide = vector<float>;
    constexpr std::size_t width = lanes<float>, across = Vectors * Panels;
    // Every third row has a pointer, and the stride reaches those between: general registers suffice.
    constexpr std::size_t pointers = (Rows + 2) / 3, sums_of_block = Rows * across;
    const std::size_t stride = rows.input_stride;
    const auto gap = // a single line has no distance
        static_cast<std::ptrdiff_t>(rows.line_distance) - static_cast<std::ptrdiff_t>(rows.depth);
    const std::size_t lines = rows.lines, depth = rows.depth;
    std::array<const float*, pointers> at;
#pragma GCC unroll 64
    for (std::size_t p = 0; p < pointers; ++p)
        at[p] = rows.input + 3 * p * stride;
    register_block<wide, Rows, across> sums;
#pragma GCC unroll 64
    for (std::size_t v = 0; v < across; ++v) {
        const wide start = end.bias ? load_as<wide>(end.bias + v * width) : wide(0.0f);
#pragma GCC unroll 64
        for (std::size_t r = 0; r < Rows; ++r)
            sums[r][v] = start;
    }
    for (std::size_t line = 0; line < lines; ++line) {
        for (std::size_t i = 0; i < depth; ++i) {
            std::array<wide, across> w;
#pragma GCC unroll 64
            for (std::size_t v = 0; v < across; ++v) {
                const float* const from = panel + v / Vectors * panel_distance + v % Vectors * width;
                w[v] = load_as<wide>(from);
                __builtin_prefetch(from + prefetch_distance);
            }
            panel += Vectors * width;
#pragma GCC unroll 64
            for (std::size_t r = 0; r < Rows; ++r) {
                const wide x(at[r / 3][r % 3 * stride]);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < across; ++v)
                    sums[r][v] = fused_multiply_add(w[v], x, sums[r][v]);
            }
#pragma GCC unroll 64
            for (std::size_t p = 0; p < pointers; ++p)
                ++at[p];
        }
#pragma GCC unroll 64
        for (std::size_t p = 0; p < pointers; ++p)
            at[p] += gap;
    }
    float* to = rows.output;
    const std::size_t to_stride = rows.output_stride;
    if (end.accumulates) {
#pragma GCC unroll 64
        for (std::size_t i = 0; i < sums_of_block; ++i) {
            wide& sum = sums[i / across][i % across];
            sum = sum + load_as<wide>(to + i % across * width);
            if (i % across + 1 == across)
                to += to_stride;
        }
        to = rows.output;
    }
    if (end.rectifies) {
#pragma GCC unroll 64
        for (std::size_t i = 0; i < sums_of_block; ++i)
            sums[i / across][i % across] = maximum_or_second(wide(0.0f), sums[i / across][i % across]);
    }
#pragma GCC unroll 64
    for (std::size_t i = 0; i < sums_of_block; ++i) {
        store_as(to + i % across * width, sums[i / across][i % across]);
        if (i % across + 1 == across)
            to += to_stride;
    }
}

/// Panels that a single row multiplies together, if they have `vectors` vectors each.
[[nodiscard]] constexpr std::size_t panels_of_one_row(std::size_t vectors) {
    return std::max<std::size_t>((vector_registers >= 32 ? 16 : 6) / vectors, 1);
}

/// `count` rows times the panels [first, last). Panels lie one after the other in the weights, beginning with
/// panel 0; output and bias begin with filter 0. A template, like the functions that call it: only programs
/// with a large layer instantiate its register blocks.
template <class = void>
void multiply_panels(panel_rows rows, std::size_t count, const filter_panels& panels, std::size_t first,
                     std::size_t last, const float* weights, epilogue end) {
    using block = void (*)(const panel_rows&, const float*, std::size_t, epilogue);
    static constexpr auto blocks = [] {
        std::array<std::array<block, max_panel_rows(1)>, max_panel_vectors> all{};
        unroll<max_panel_vectors>([&](auto v) {
            constexpr std::size_t vectors = v + 1;
            unroll<max_panel_rows(vectors)>([&](auto r) { all[v][r] = multiply_panel<r + 1, vectors>; });
        });
        return all;
    }();
    static constexpr auto one_row = [] {
        std::array<block, max_panel_vectors> all{};
        unroll<max_panel_vectors>([&](auto v) {
            constexpr std::size_t vectors = v + 1;
            all[v] = multiply_panel<1, vectors, panels_of_one_row(vectors)>;
        });
        return all;
    }();
    const std::size_t depth = rows.lines * rows.depth;
    for (std::size_t panel = first; panel < last;) {
        const std::size_t vectors = panels.size(panel), filter = panels.begin(panel);
        const float* const from = weights + filter * depth;
        panel_rows some = rows;
        some.output += filter;
        epilogue some_end = end;
        if (end.bias)
            some_end.bias += filter;
        const std::size_t at_once = panels_of_one_row(vectors);
        if (count == 1 && panel + at_once <= last &&
            panels.begin(panel + at_once) - filter == at_once * vectors * lanes<float> &&
            panels.size(panel + at_once - 1) == vectors) {
            one_row[vectors - 1](some, from, vectors * lanes<float> * depth, some_end);
            panel += at_once;
            continue;
        }
        // Pieces of nearly the same size: a rest of few rows would be bound by the latency of its sums.
        const std::size_t most = max_panel_rows(vectors), pieces = ceil_div(count, most);
        for (std::size_t p = 0; p < pieces; ++p) {
            const std::size_t size = count / pieces + (p < count % pieces);
            blocks[vectors - 1][size - 1](some, from, 0, some_end);
            some.input += size * rows.input_stride, some.output += size * rows.output_stride;
        }
        ++panel;
    }
}

}}} // namespace tactnet::kernels
