#pragma once

#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/convolution/direct_layout.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <cstddef>

// The sums of a register block of the direct convolution in integers: how they begin, and the products of all
// taps, pixel by pixel, in pairs of pixels, or weight by weight.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace detail {

/// The input rows under a register block that are multiplied.
struct row_range {
    std::size_t first, last;
};

/// The first terms of the sums of a register block.
template <class Layout, std::size_t Vectors, std::size_t Rows, std::size_t Columns, class Output,
          frame_convolution C = Layout::convolution>
[[gnu::always_inline]] inline void
start_integer_sums(register_block<int32_vec<Layout::width>, Rows * Columns, Vectors>& sums,
                   const integer_epilogue& epilogue, const Output* output) {
    constexpr std::size_t width = Layout::width;
#pragma GCC unroll 64
    for (std::size_t v = 0; v < Vectors; ++v) {
        const int32_vec<width> start = epilogue.start<width>(v);
#pragma GCC unroll 64
        for (std::size_t p = 0; p < Rows * Columns; ++p) {
            sums[p][v] = start;
            if constexpr (C.accumulates)
                sums[p][v] += epilogue.added_term<width>(
                    output + (p / Columns * C.output_columns() + p % Columns) * C.output_stride() + v * width,
                    v);
        }
    }
}

/// Adds the products of all taps to the sums of a register block.
template <class Layout, std::size_t Vectors, std::size_t Rows, std::size_t Columns,
          frame_convolution C = Layout::convolution>
[[gnu::always_inline]] inline void
add_integer_products(register_block<int32_vec<Layout::width>, Rows * Columns, Vectors>& sums,
                     const typename Layout::staged* input, const typename Layout::weight* weights,
                     row_range multiplied) {
    constexpr std::size_t step = C.window.stride.columns;
    constexpr std::size_t footprint_rows = (Rows - 1) * C.window.stride.rows + C.window.kernel.rows;
    constexpr std::size_t under_columns =
        (Columns - 1) * step + (Layout::groups_of_row - 1) * Layout::columns_of_group + 1;
    constexpr std::size_t of_group =
        C.window.kernel.rows * Layout::groups_of_row * Vectors * Layout::weights_of_group;
    for (std::size_t in_pixel = 0; in_pixel < Layout::groups_of_pixel; ++in_pixel) {
        prefetch_weights<of_group * sizeof(*weights), Layout::weights * sizeof(*weights), Rows * Columns>(
            weights + prefetch_distance_bytes / sizeof(*weights));
#pragma GCC unroll 64
        for (std::size_t r = 0; r < footprint_rows; ++r) {
            if (r < multiplied.first || r >= multiplied.last)
                continue;
            typename Layout::products::inputs x[under_columns];
#pragma GCC unroll 64
            for (std::size_t c = 0; c < under_columns; ++c)
                x[c] = Layout::load(input + r * Layout::pitch + c * Layout::stride);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < Rows; ++y) {
                const std::size_t above = y * C.window.stride.rows;
                if (r < above || r - above >= C.window.kernel.rows)
                    continue;
#pragma GCC unroll 64
                for (std::size_t tap = 0; tap < Layout::groups_of_row * Vectors; ++tap) {
                    const std::size_t in_row = tap / Vectors, v = tap % Vectors;
                    const auto weight = Layout::products::load(
                        weights +
                        ((r - above) * Layout::groups_of_row * Vectors + tap) * Layout::weights_of_group);
#pragma GCC unroll 64
                    for (std::size_t p = 0; p < Columns; ++p)
                        sums[y * Columns + p][v] =
                            Layout::products::add(sums[y * Columns + p][v], weight,
                                                  x[p * step + in_row * Layout::columns_of_group]);
                }
            }
        }
        input += Layout::group;
        weights += of_group;
    }
}

/// The same for pairs of pixels. The last pixel of an odd row is its own neighbour, whose sums are left.
template <class Layout, std::size_t Vectors, std::size_t Rows, std::size_t Columns,
          frame_convolution C = Layout::convolution>
[[gnu::always_inline]] inline void
add_products_of_pairs(register_block<int32_vec<Layout::width>, Rows * Columns, Vectors>& sums,
                      const typename Layout::staged* input, const typename Layout::weight* weights,
                      row_range multiplied) {
    using products = typename Layout::products;
    constexpr std::size_t footprint_rows = (Rows - 1) * C.window.stride.rows + C.window.kernel.rows;
    constexpr std::size_t step = C.window.stride.columns * Layout::stride;
    register_block<int32_vec<Layout::width>, Rows, Vectors> unused;
    const auto for_pairs = [&](std::size_t y, std::size_t v, const auto& of_pair) {
#pragma GCC unroll 64
        for (std::size_t x = 0; x < Columns; x += 2)
            of_pair(x, sums[y * Columns + x][v],
                    x + 1 < Columns ? sums[y * Columns + x + 1][v] : unused[y][v]);
    };
    const auto exchange = [&] {
#pragma GCC unroll 64
        for (std::size_t i = 0; i < Rows * Vectors; ++i)
            for_pairs(i / Vectors, i % Vectors,
                      [](std::size_t, auto& first, auto& second) { products::exchange(first, second); });
    };
#pragma GCC unroll 64
    for (std::size_t i = 0; i < Rows * Vectors; ++i)
        unused[i / Vectors][i % Vectors] = int32_vec<Layout::width>{};
    exchange();
    for (std::size_t in_pixel = 0; in_pixel < Layout::groups_of_pixel; ++in_pixel) {
#pragma GCC unroll 64
        for (std::size_t r = 0; r < footprint_rows; ++r) {
            if (r < multiplied.first || r >= multiplied.last)
                continue;
#pragma GCC unroll 64
            for (std::size_t y = 0; y < Rows; ++y) {
                const std::size_t above = y * C.window.stride.rows;
                if (r < above || r - above >= C.window.kernel.rows)
                    continue;
#pragma GCC unroll 64
                for (std::size_t tap = 0; tap < Layout::groups_of_row * Vectors; ++tap) {
                    const auto weight =
                        products::load(weights + ((r - above) * Layout::groups_of_row * Vectors + tap) *
                                                     Layout::weights_of_group);
                    const auto* const under =
                        input + r * Layout::pitch + tap / Vectors * Layout::columns_of_group * Layout::stride;
                    for_pairs(y, tap % Vectors, [&](std::size_t x, auto& first, auto& second) {
                        products::add(first, second, weight,
                                      products::load_pair(under + x * step, x + 1 < Columns ? step : 0));
                    });
                }
            }
        }
        input += Layout::group;
        weights += C.window.kernel.rows * Layout::groups_of_row * Vectors * Layout::weights_of_group;
    }
    exchange();
}

/// The same for one vector of filters, in another order.
template <class Layout, std::size_t Rows, std::size_t Columns, frame_convolution C = Layout::convolution>
[[gnu::always_inline]] inline void
add_products_of_weights(register_block<int32_vec<Layout::width>, Rows * Columns, 1>& sums,
                        const typename Layout::staged* input, const typename Layout::weight* weights,
                        row_range multiplied) {
    constexpr std::size_t from_row = C.window.stride.rows * Layout::pitch;
    input += (Rows - 1) * from_row;
    for (std::size_t in_pixel = 0; in_pixel < Layout::groups_of_pixel; ++in_pixel) {
#pragma GCC unroll 64
        for (std::size_t row = 0; row < C.window.kernel.rows; ++row) {
            asm("" : "+r"(input)); // one address per row, near enough to be an offset from it
#pragma GCC unroll 64
            for (std::size_t in_row = 0; in_row < Layout::groups_of_row; ++in_row) {
                const auto weight = Layout::products::load(weights);
                weights += Layout::weights_of_group;
#pragma GCC unroll 64
                for (std::size_t p = 0; p < Rows * Columns; ++p) {
                    const std::size_t r = p / Columns * C.window.stride.rows + row;
                    if (r < multiplied.first || r >= multiplied.last)
                        continue;
                    const std::size_t column =
                        p % Columns * C.window.stride.columns + in_row * Layout::columns_of_group;
                    sums[p][0] = Layout::products::add(
                        sums[p][0], weight,
                        Layout::load(input + column * Layout::stride - (Rows - 1 - p / Columns) * from_row));
                }
            }
            input += Layout::pitch;
        }
        input += Layout::group;
        input -= C.window.kernel.rows * Layout::pitch;
    }
}

}}}} // namespace tactnet::kernels::detail
