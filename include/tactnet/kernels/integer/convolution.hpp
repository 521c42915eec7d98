#pragma once

#include <tactnet/kernels/frame/convolution.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/integer/staging.hpp>
#include <tactnet/kernels/integer/vector.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Convolution of one frame in whole numbers, for networks deployed in 8 bits, of an input that has been
// staged (staging.hpp). A block of pixels × vectors of filters stays in registers while all groups are added,
// then max pool, rounding and ReLU are applied to it.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Where sums begin and what becomes of them: for each filter a start, the factor before rounding and, where
/// the step adds, how often the other map's byte counts.
struct integer_epilogue {
    const std::int8_t* starts;  ///< whole numbers of 32 bits
    const std::int8_t* factors; ///< in single precision
    const std::int8_t* added;   ///< whole numbers of 32 bits
    byte_range range;
    bool padding_counts = true; ///< not if the padding is zero as it is staged: its taps are left out

    /// Of the filters from `first` on.
    [[nodiscard]] integer_epilogue from(std::size_t first) const {
        const std::size_t bytes = first * sizeof(std::int32_t);
        return {starts + bytes, factors + bytes, added + bytes, range, padding_counts};
    }
};

/// The rows under the taps of a register block that are multiplied.
struct rows_under_taps {
    std::size_t first, last;
};

/// One register block: `Rows` × `Columns` neighbouring outputs before pooling × `Vectors` vectors of filters.
/// `Output` is a byte, or a float in which the sum × factor is left unrounded.
template <class Plan, frame_convolution C, std::size_t Vectors, std::size_t Rows, std::size_t Columns,
          class Output>
[[gnu::flatten, gnu::noinline]] void
convolve_integer_block(const typename Plan::staged* input, const typename Plan::weight* weights,
                       const integer_epilogue& epilogue, Output* output, rows_under_taps multiplied) {
    constexpr std::size_t width = Plan::width;
    using sum = int32_vec<width>;
    register_block<sum, Rows * Columns, Vectors> sums;
#pragma GCC unroll 64
    for (std::size_t v = 0; v < Vectors; ++v) {
        const sum start = load_any<sum>(epilogue.starts + v * width * sizeof(std::int32_t));
#pragma GCC unroll 64
        for (std::size_t p = 0; p < Rows * Columns; ++p) {
            sums[p][v] = start;
            if constexpr (C.adds) {
                const auto other = load_any<uint8_vec<width>>(
                    output + (p / Columns * C.output_columns() + p % Columns) * C.output_stride() +
                    v * width);
                sums[p][v] += __builtin_convertvector(other, sum) *
                              load_any<sum>(epilogue.added + v * width * sizeof(std::int32_t));
            }
        }
    }

    constexpr std::size_t step = C.window.stride.columns;
    constexpr std::size_t under_rows = (Rows - 1) * C.window.stride.rows + C.window.kernel.rows;
    constexpr std::size_t under_columns =
        (Columns - 1) * step + (Plan::groups_of_row - 1) * Plan::columns_of_group + 1;
    for (std::size_t in_pixel = 0; in_pixel < Plan::groups_of_pixel; ++in_pixel) {
#pragma GCC unroll 64
        for (std::size_t r = 0; r < under_rows; ++r) {
            if constexpr (!Plan::few_registers) // else to ask takes as long as to multiply
                if (r < multiplied.first || r >= multiplied.last)
                    continue;
            typename Plan::products::inputs x[under_columns];
#pragma GCC unroll 64
            for (std::size_t c = 0; c < under_columns; ++c)
                x[c] = Plan::products::broadcast(input + r * Plan::pitch + c * Plan::stride);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < Rows; ++y) {
                const std::size_t above = y * C.window.stride.rows;
                if (r < above || r - above >= C.window.kernel.rows)
                    continue;
#pragma GCC unroll 64
                for (std::size_t tap = 0; tap < Plan::groups_of_row * Vectors; ++tap) {
                    const std::size_t in_row = tap / Vectors, v = tap % Vectors;
                    const auto weight =
                        Plan::products::load(weights + ((r - above) * Plan::groups_of_row * Vectors + tap) *
                                                           Plan::weights_of_group);
#pragma GCC unroll 64
                    for (std::size_t p = 0; p < Columns; ++p)
                        sums[y * Columns + p][v] = Plan::products::add(
                            sums[y * Columns + p][v], weight, x[p * step + in_row * Plan::columns_of_group]);
                }
            }
        }
        input += Plan::group;
        weights += C.window.kernel.rows * Plan::groups_of_row * Vectors * Plan::weights_of_group;
    }

    constexpr std::size_t pooled_columns = (Columns + C.pool.columns - 1) / C.pool.columns;
#pragma GCC unroll 64
    for (std::size_t v = 0; v < Vectors; ++v) {
        const auto factors = load_any<float_vec<width>>(epilogue.factors + v * width * sizeof(float));
#pragma GCC unroll 64
        for (std::size_t o = 0; o < (Rows + C.pool.rows - 1) / C.pool.rows * pooled_columns; ++o) {
            const std::size_t top = o / pooled_columns * C.pool.rows,
                              left = o % pooled_columns * C.pool.columns;
            const std::size_t high = std::min(C.pool.rows, Rows - top),
                              across = std::min(C.pool.columns, Columns - left);
            sum largest = sums[top * Columns + left][v];
#pragma GCC unroll 64
            for (std::size_t i = 1; i < high * across; ++i) {
                const sum& other = sums[(top + i / across) * Columns + left + i % across][v];
                largest = other > largest ? other : largest;
            }
            Output* const to =
                output + (o / pooled_columns * C.output_columns() + o % pooled_columns) * C.output_stride() +
                v * width;
            if constexpr (std::is_same_v<Output, float>) {
                if constexpr (C.rectified)
                    largest = largest > 0 ? largest : sum{};
                store_any(to, __builtin_convertvector(largest, float_vec<width>) * factors);
            } else {
                store_rounded<width>(to, largest, factors, epilogue.range);
            }
        }
    }
}

/// output = the fused step, of a staged input. Maps lie pixel by pixel.
template <class Plan, frame_convolution C, class Output>
void convolve_integer(const typename Plan::staged* input, const typename Plan::weight* weights,
                      const integer_epilogue& epilogue, Output* output) {
    blocked<Plan::vectors, Plan::block_vectors>([&](auto vectors, std::size_t first_vector) {
        const std::size_t first = first_vector * Plan::width;
        const auto* const of_block = weights + first_vector * (Plan::weights / Plan::vectors);
        const integer_epilogue here = epilogue.from(first);
        blocked<C.rows(), Plan::block_rows>([&](auto rows, std::size_t y) {
            const std::size_t above = y * C.window.stride.rows; // row under the first tap, with the padding
            rows_under_taps multiplied{0, (rows - 1) * C.window.stride.rows + C.window.kernel.rows};
            if (!epilogue.padding_counts)
                multiplied = {
                    C.window.top - std::min(C.window.top, above),
                    std::min(multiplied.last, std::max(C.window.top + C.window.input.rows, above) - above)};
            blocked<C.columns(), Plan::block_columns>([&](auto columns, std::size_t x) {
                convolve_integer_block<Plan, C, vectors, rows, columns>(
                    input + above * Plan::pitch + x * C.window.stride.columns * Plan::stride, of_block, here,
                    output + (y / C.pool.rows * C.output_columns() + x / C.pool.columns) * C.output_stride() +
                        first,
                    multiplied);
            });
        });
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
