#pragma once

#include <tactnet/kernels/frame/fused_convolution.hpp>
#include <tactnet/kernels/integer/products.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

// Convolution of one frame in whole numbers, for networks deployed in 8 bits. The input is first staged: laid
// out once more with its padding around it, in the type that the instruction set multiplies, so that a group
// of inputs that it multiplies at once lies side by side: channels of one pixel, or, where a pixel has fewer,
// those of neighbours in a row. A block of pixels × vectors of filters stays in registers while all groups
// are added, then max pool, rounding and ReLU are applied to it.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// How a fused convolution `C` is computed in whole numbers from inputs of type `Input`, bytes or words of 16
/// bits. Groups of filters must have been joined.
template <frame_convolution C, class Input>
struct integer_convolution {
    static_assert(C.groups == 1, "integer_convolution: groups of filters must have been joined");
    static constexpr std::size_t width = std::min(C.width(), most_integer_lanes);
    using products =
        std::conditional_t<std::is_same_v<Input, std::uint8_t>, byte_products<width>, word_products<width>>;
    using staged = typename products::staged;
    static constexpr std::size_t group = products::group;
    /// What is subtracted from inputs when they are staged.
    static constexpr int offset = std::is_same_v<Input, std::uint8_t> ? products::offset : 0;

    static constexpr std::size_t vectors = C.padded_filters() / width;
    static constexpr std::size_t block_vectors = C.block_vectors();

    /// Of the staged input: elements from one pixel to the next, a multiple of the group or a part of it;
    /// from one row to the next; rows; all of it, with what a last group may read behind its taps.
    static constexpr std::size_t stride =
        C.input_stride < group ? std::bit_ceil(C.input_stride) : (C.input_stride + group - 1) / group * group;
    static constexpr std::size_t pitch = (C.window.input.columns + C.window.left + C.window.right) * stride;
    static constexpr std::size_t rows = C.window.input.rows + C.window.top + C.window.bottom;
    static constexpr std::size_t staged_elements = rows * pitch + group;

    /// Groups in a pixel, columns in a group, groups over the columns of the kernel.
    static constexpr std::size_t groups_of_pixel = std::max<std::size_t>(stride / group, 1),
                                 columns_of_group = std::max<std::size_t>(group / stride, 1),
                                 groups_of_row =
                                     (C.window.kernel.columns + columns_of_group - 1) / columns_of_group;
    static constexpr std::size_t weights_of_group = width * group;
    using weight = typename products::weight;
    static constexpr std::size_t weights =
        vectors * groups_of_pixel * C.window.kernel.rows * groups_of_row * weights_of_group;
    static constexpr std::size_t weight_bytes = weights * sizeof(weight);
};

/// Weights in the order of use: blocks of vectors of filters, then [group of the pixel][kernel row][group of
/// the row][vector][filter][input of the group]; zeros where there is no filter or no tap. `weight(filter,
/// channel, row, column)`.
template <class Plan, frame_convolution C, class Weight>
constexpr void pack_integer_weights(std::int8_t* packed, Weight&& weight) {
    const auto of_tap = [&](std::size_t filter, std::size_t in_pixel, std::size_t row, std::size_t in_row,
                            std::size_t element) {
        const std::size_t column = in_row * Plan::columns_of_group + element / Plan::stride;
        const std::size_t channel = in_pixel * Plan::group + element % Plan::stride;
        return filter < C.filters && column < C.window.kernel.columns && channel < C.window.input.channels
                   ? weight(filter, channel, row, column)
                   : std::int8_t{0};
    };
    for (std::size_t first = 0; first < Plan::vectors; first += Plan::block_vectors) {
        const std::size_t last = std::min(first + Plan::block_vectors, Plan::vectors);
        for (std::size_t in_pixel = 0; in_pixel < Plan::groups_of_pixel; ++in_pixel)
            for (std::size_t row = 0; row < C.window.kernel.rows; ++row)
                for (std::size_t in_row = 0; in_row < Plan::groups_of_row; ++in_row)
                    for (std::size_t filter = first * Plan::width; filter < last * Plan::width; ++filter)
                        for (std::size_t element = 0; element < Plan::group; ++element) {
                            const auto bytes =
                                std::bit_cast<std::array<std::int8_t, sizeof(typename Plan::weight)>>(
                                    typename Plan::weight{of_tap(filter, in_pixel, row, in_row, element)});
                            packed = std::copy(bytes.begin(), bytes.end(), packed);
                        }
    }
}

/// The input with its padding around it. `padding` stands for zero.
template <class Plan, frame_convolution C, class Input>
void stage(const Input* from, typename Plan::staged* to, Input padding) {
    using staged = typename Plan::staged;
    constexpr std::size_t stride = C.input_stride, columns = C.window.input.columns;
    const auto convert = [](Input x) { return static_cast<staged>(x - Plan::offset); };
    const auto fill = [&](std::size_t pixels) {
        std::fill_n(to, pixels * Plan::stride, convert(padding));
        to += pixels * Plan::stride;
    };
    const auto copy = [&](std::size_t pixels) {
        if constexpr (std::is_same_v<Input, staged>)
            std::memcpy(to, from, pixels * stride * sizeof(staged));
        else
            for (std::size_t e = 0; e < pixels * stride; ++e)
                to[e] = convert(from[e]);
        from += pixels * stride, to += pixels * Plan::stride;
    };
    fill(C.window.top * (Plan::pitch / Plan::stride) + C.window.left);
    for (std::size_t row = 0; row < C.window.input.rows; ++row) {
        if (row > 0)
            fill(C.window.left + C.window.right);
        if constexpr (Plan::stride == stride) {
            copy(columns);
        } else {
            for (std::size_t x = 0; x < columns; ++x) {
                std::fill_n(to + stride, Plan::stride - stride, staged{});
                copy(1);
            }
        }
    }
    fill(C.window.right + C.window.bottom * (Plan::pitch / Plan::stride));
    std::fill_n(to, Plan::group, staged{});
}

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
    using sum = integers<width>;
    register_block<sum, Rows * Columns, Vectors> sums;
#pragma GCC unroll 64
    for (std::size_t v = 0; v < Vectors; ++v) {
        const sum start = load_any<sum>(epilogue.starts + v * width * sizeof(std::int32_t));
#pragma GCC unroll 64
        for (std::size_t p = 0; p < Rows * Columns; ++p) {
            sums[p][v] = start;
            if constexpr (C.adds) {
                const auto other = load_any<typename integer_lanes<width>::bytes>(
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
            if (r < multiplied.first || r >= multiplied.last)
                continue;
            typename Plan::products::inputs x[under_columns];
#pragma GCC unroll 64
            for (std::size_t c = 0; c < under_columns; ++c)
                x[c] = Plan::products::spread(input + r * Plan::pitch + c * Plan::stride);
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
        const auto factors = load_any<numbers<width>>(epilogue.factors + v * width * sizeof(float));
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
                store_any(to, __builtin_convertvector(largest, numbers<width>) * factors);
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
        blocked<C.rows(), C.block_rows()>([&](auto rows, std::size_t y) {
            const std::size_t above = y * C.window.stride.rows; // row under the first tap, with the padding
            rows_under_taps multiplied{0, (rows - 1) * C.window.stride.rows + C.window.kernel.rows};
            if (!epilogue.padding_counts)
                multiplied = {
                    C.window.top - std::min(C.window.top, above),
                    std::min(multiplied.last, std::max(C.window.top + C.window.input.rows, above) - above)};
            blocked<C.columns(), C.block_columns()>([&](auto columns, std::size_t x) {
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
