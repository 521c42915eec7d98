#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/convolution/direct_layout.hpp>
#include <tactnet/kernels/integer/convolution/direct_products.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

// The direct convolution of one frame in integers: the products of all taps, from an input that was staged
// (direct_layout.hpp). A block of pixels × vectors of filters stays in registers while all groups are added;
// then max pool, rounding and ReLU are applied to it.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// The largest sum of a pool's window, the `o`-th of a register block.
template <frame_convolution C, std::size_t Rows, std::size_t Columns, class Sums>
[[nodiscard]] [[gnu::always_inline]] inline auto largest_sum(const Sums& sums, std::size_t v, std::size_t o) {
    constexpr std::size_t pooled_columns = ceil_div(Columns, C.pool.columns);
    const std::size_t top = o / pooled_columns * C.pool.rows, left = o % pooled_columns * C.pool.columns;
    const std::size_t high = std::min(C.pool.rows, Rows - top),
                      across = std::min(C.pool.columns, Columns - left);
    auto largest = sums[top * Columns + left][v];
#pragma GCC unroll 64
    for (std::size_t i = 1; i < high * across; ++i) {
        const auto& other = sums[(top + i / across) * Columns + left + i % across][v];
        largest = other > largest ? other : largest;
    }
    return largest;
}

/// Computes one register block: `Rows` × `Columns` neighbouring outputs before pooling × `Vectors` vectors of
/// filters. `Output` is a byte, or a float for sum × factor without rounding.
template <class Layout, std::size_t Vectors, std::size_t Rows, std::size_t Columns, class Output,
          frame_convolution C = Layout::convolution>
[[gnu::flatten, gnu::noinline]] void
convolve_integer_block(const typename Layout::staged* input, const typename Layout::weight* weights,
                       const integer_epilogue& epilogue, Output* output, row_range multiplied) {
    constexpr std::size_t width = Layout::width;
    register_block<int32_vec<width>, Rows * Columns, Vectors> sums;
    start_integer_sums<Layout, Vectors, Rows, Columns>(sums, epilogue, output);
    if constexpr (Layout::in_pairs)
        add_products_of_pairs<Layout, Vectors, Rows, Columns>(sums, input, weights, multiplied);
    else
        add_integer_products<Layout, Vectors, Rows, Columns>(sums, input, weights, multiplied);
    constexpr std::size_t pooled_columns = ceil_div(Columns, C.pool.columns),
                          pooled = ceil_div(Rows, C.pool.rows) * pooled_columns;
#pragma GCC unroll 64
    for (std::size_t v = 0; v < Vectors; ++v) {
        const float_vec<width> factors = epilogue.factor<width>(v);
#pragma GCC unroll 64
        for (std::size_t o = 0; o < pooled; ++o)
            epilogue.store<width, C.rectifies()>(
                output + (o / pooled_columns * C.output_columns() + o % pooled_columns) * C.output_stride() +
                    v * width,
                largest_sum<C, Rows, Columns>(sums, v, o), factors);
    }
}

/// Computes the same for all filters, one register block after the other, where blocks are so small that a
/// call for each would take a large part of the time. Sums of as many filters as one instruction rounds are
/// rounded together. The first `Above` input rows under the block and the last `Below` are left out: a branch
/// would take as long as a product.
template <class Layout, std::size_t Rows, std::size_t Columns, std::size_t Above, std::size_t Below,
          class Output, frame_convolution C = Layout::convolution>
[[gnu::flatten, gnu::noinline]] void
convolve_integer_filters(const typename Layout::staged* input, const typename Layout::weight* weights,
                         const integer_epilogue& of_all, Output* output) {
    static_assert(Layout::width == 1);
    constexpr row_range multiplied{Above, (Rows - 1) * C.window.stride.rows + C.window.kernel.rows - Below};
    constexpr std::size_t vectors = Layout::block_vectors,
                          together = std::max(instructions::rounded_lanes, vectors);
    constexpr std::size_t pooled_columns = ceil_div(Columns, C.pool.columns),
                          pooled = ceil_div(Rows, C.pool.rows) * pooled_columns;
    static_assert(Layout::vectors % together == 0 && together % vectors == 0);
    const integer_epilogue epilogue = of_all; // stores of bytes cannot change a copy
    for (std::size_t first = 0; first < Layout::vectors; first += together) {
        std::array<std::array<std::int32_t, together>, pooled> results;
        for (std::size_t f = 0; f < together; f += vectors) {
            register_block<int32_vec<1>, Rows * Columns, vectors> sums;
            start_integer_sums<Layout, vectors, Rows, Columns>(sums, epilogue.from(first + f),
                                                               output + first + f);
            if constexpr (instructions::weight_by_weight && vectors == 1)
                add_products_of_weights<Layout, Rows, Columns>(sums, input, weights, multiplied);
            else
                add_integer_products<Layout, vectors, Rows, Columns>(sums, input, weights, multiplied);
            weights += vectors * (Layout::weights / Layout::vectors);
#pragma GCC unroll 64
            for (std::size_t v = 0; v < vectors; ++v)
#pragma GCC unroll 64
                for (std::size_t o = 0; o < pooled; ++o)
                    results[o][f + v] = largest_sum<C, Rows, Columns>(sums, v, o)[0];
        }
        constexpr std::size_t lanes = instructions::rounded_lanes;
#pragma GCC unroll 64
        for (std::size_t o = 0; o < pooled; ++o)
#pragma GCC unroll 64
            for (std::size_t f = 0; f < together; f += lanes)
                epilogue.store<lanes, C.rectifies()>(
                    output +
                        (o / pooled_columns * C.output_columns() + o % pooled_columns) * C.output_stride() +
                        first + f,
                    load_bytes_as<int32_vec<lanes>>(&results[o][f]),
                    epilogue.factor<lanes>((first + f) / lanes));
    }
}

} // namespace detail

/// The direct method, for any convolution; groups are one convolution with zeros between them.
template <frame_convolution C, class Input>
struct direct_integer_method {
    using layout = direct_integer_layout<C.ungrouped(), Input>;
    static constexpr const char* name = "direct";
    static constexpr bool applicable = true;
    /// Instructions for products. Those of four bytes add to the sums themselves.
    static constexpr std::size_t vector_instructions =
        (layout::group == 4 || layout::in_pairs ? 1 : 2) * C.rows() * C.columns() * C.window.kernel.area() *
        ceil_div(C.window.input.channels, layout::group) * layout::vectors;
    static constexpr std::size_t packed_elements = layout::weights * sizeof(typename layout::weight),
                                 workspace_elements =
                                     layout::staged_elements * sizeof(typename layout::staged);
    static constexpr int offset = layout::offset; ///< is subtracted from inputs before they are multiplied
    static constexpr std::size_t filter_places = C.padded_filters();
    static constexpr std::size_t place(std::size_t filter) { return filter; }

    template <class Weight>
    static constexpr void pack(const Weight& weight, std::int8_t* to) {
        layout::pack(ungrouped_weight<C>(weight), to);
    }
    template <class Output>
    static void run(const std::int8_t* packed, const integer_epilogue& epilogue, const Input* input,
                    Output* output, [[maybe_unused]] std::uint8_t* workspace) {
        const typename layout::staged* staged = nullptr;
        if constexpr (layout::in_place) {
            staged = input;
        } else {
            auto* const copy = reinterpret_cast<typename layout::staged*>(workspace);
            layout::stage(input, copy, static_cast<Input>(epilogue.padding));
            staged = copy;
        }
        const auto* const weights = reinterpret_cast<const typename layout::weight*>(packed);
        if constexpr (layout::few_registers)
            run_filters(staged, weights, epilogue, output);
        else
            run_blocks(staged, weights, epilogue, output);
    }

private:
    /// All filters of a block after the other. Where blocks of the first or the last row are a large part of
    /// all, they leave out rows of padding, whose products are zero unless it counts. Each of them is code of
    /// its own, which is small compared with such weights.
    template <class Output>
    static void run_filters(const typename layout::staged* staged, const typename layout::weight* weights,
                            const integer_epilogue& epilogue, Output* output) {
        constexpr bool leaves_out =
            offset == 0 && C.rows() <= 4 * layout::block_rows && packed_elements >= 4096;
        constexpr std::size_t reach = (C.rows() - 1) * C.window.stride.rows + C.window.kernel.rows,
                              inside = C.window.top + C.window.input.rows;
        constexpr constant<leaves_out ? C.window.top : 0> above;
        constexpr constant<leaves_out ? std::max(reach, inside) - inside : 0> below;
        constexpr constant<0> none;
        blocked<C.rows(), layout::block_rows>([&](auto rows, std::size_t y) {
            const auto run_row = [&](auto first, auto last) {
                blocked<C.columns(), layout::block_columns>([&](auto columns, std::size_t x) {
                    detail::convolve_integer_filters<layout, rows, columns, first, last>(
                        staged + y * C.window.stride.rows * layout::pitch +
                            x * C.window.stride.columns * layout::stride,
                        weights, epilogue,
                        output +
                            (y / C.pool.rows * C.output_columns() + x / C.pool.columns) * C.output_stride());
                });
            };
            const bool first = epilogue.padding == 0 && y == 0,
                       last = epilogue.padding == 0 && y + rows == C.rows();
            if constexpr (C.rows() == rows) {
                if (first)
                    return run_row(above, below);
            } else {
                if (above > 0 && first)
                    return run_row(above, none);
                if (below > 0 && last)
                    return run_row(none, below);
            }
            run_row(none, none);
        });
    }
    /// A few vectors of filters after the other.
    template <class Output>
    static void run_blocks(const typename layout::staged* staged, const typename layout::weight* weights,
                           const integer_epilogue& epilogue, Output* output) {
        const bool padding_counts = offset != 0 || epilogue.padding != 0; // else its taps can be left out
        blocked<layout::vectors, layout::block_vectors>([&](auto vectors, std::size_t first_vector) {
            const std::size_t first = first_vector * layout::width;
            const auto* const of_block = weights + first_vector * (layout::weights / layout::vectors);
            const integer_epilogue here = epilogue.from(first);
            blocked<C.rows(), layout::block_rows>([&](auto rows, std::size_t y) {
                const std::size_t above = y * C.window.stride.rows; // the first row, counted with the padding
                detail::row_range multiplied{0, (rows - 1) * C.window.stride.rows + C.window.kernel.rows};
                if (!padding_counts)
                    multiplied = {C.window.top - std::min(C.window.top, above),
                                  std::min(multiplied.last,
                                           std::max(C.window.top + C.window.input.rows, above) - above)};
                blocked<C.columns(), layout::block_columns>([&](auto columns, std::size_t x) {
                    detail::convolve_integer_block<layout, vectors, rows, columns>(
                        staged + above * layout::pitch + x * C.window.stride.columns * layout::stride,
                        of_block, here,
                        output +
                            (y / C.pool.rows * C.output_columns() + x / C.pool.columns) * C.output_stride() +
                            first,
                        multiplied);
                });
            });
        });
    }
};

}}} // namespace tactnet::kernels
