#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/batch_convolution.hpp>
#include <tactnet/kernels/method_list.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>

// Direct convolution of one lane block. A register block of neighbouring outputs × output channels
// accumulates all taps; taps on padding are skipped. The sum of one output runs over channel, kernel row and
// kernel column in this order, whatever the blocking, so that results do not depend on it.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Output channels × neighbouring outputs of a register block: accumulators, inputs and a weight must fit
/// into the registers.
inline constexpr std::size_t block_channels = vector_registers >= 32 ? 8 : 4;
inline constexpr std::size_t block_outputs = 3;

/// The cost in halves of a multiply-add: twice the taps on pixels, for each channel of the group and filter.
[[nodiscard]] constexpr std::size_t direct_cost(const batch_convolution& c) {
    std::size_t rows = 0, columns = 0;
    for (std::size_t phase = 0; phase < c.spacing.rows; ++phase)
        rows += c.row_axis(phase).taps_on_pixels();
    for (std::size_t phase = 0; phase < c.spacing.columns; ++phase)
        columns += c.column_axis(phase).taps_on_pixels();
    return 2 * rows * columns * (c.input.channels / c.groups) * c.output.channels;
}

/// The cost of a weight gradient by taps, in halves of a multiply-add, if so many bands of rows are
/// accumulated in the working precision. A sum that is added to its total counts as one and a half
/// multiply-adds.
[[nodiscard]] constexpr std::size_t direct_gradient_cost(const batch_convolution& c, std::size_t bands) {
    return direct_cost(c) + bands * c.weights() * 3;
}

/// Adds one tap to a register block.
template <batch_convolution C, tap_axis Columns, std::size_t Outputs, std::size_t Channels, class T>
[[gnu::always_inline]] inline void add_tap(std::array<std::array<vector<T>, Outputs>, Channels>& sums,
                                           const T* input, const T* weights, std::size_t tap) {
    std::array<vector<T>, Outputs> x;
#pragma GCC unroll 64
    for (std::size_t o = 0; o < Outputs; ++o)
        x[o] = load(input + (tap + o * Columns.step) * lanes<T>);
#pragma GCC unroll 64
    for (std::size_t c = 0; c < Channels; ++c) {
        const vector<T> weight(weights[tap * C.spacing.columns * Channels + c]);
#pragma GCC unroll 64
        for (std::size_t o = 0; o < Outputs; ++o)
            sums[c][o] = multiply_add(weight, x[o], sums[c][o]);
    }
}

/// Adds the taps [first_tap, last_tap) of `Outputs` neighbouring outputs × `Channels` channels.
template <batch_convolution C, tap_axis Columns, std::size_t Outputs, std::size_t Channels, class T>
[[gnu::always_inline]] inline void
correlate_block(const T* input, const T* weights, const T* bias, T* output, std::ptrdiff_t row_position,
                std::size_t first_row, std::size_t last_row, std::size_t row_kernel_first, std::size_t index,
                std::size_t first_tap, std::size_t last_tap) {
    constexpr std::size_t width = lanes<T>;
    constexpr std::size_t output_step =
        (Columns.step == 1 && C.stride.columns == 1 ? C.spacing.columns : 1) * width;
    std::array<std::array<vector<T>, Outputs>, Channels> sums;
#pragma GCC unroll 64
    for (std::size_t c = 0; c < Channels; ++c)
        sums[c].fill(vector<T>(bias ? bias[c] : T{}));
    const std::ptrdiff_t column_position = Columns.position(index);
    for (std::size_t channel = 0; channel < C.input.channels; ++channel) {
        for (std::size_t row = first_row; row < last_row; ++row) {
            const auto pixel = (static_cast<std::ptrdiff_t>(channel * C.input.rows + row) + row_position) *
                                   static_cast<std::ptrdiff_t>(C.input.columns) +
                               column_position;
            const T* from = input + pixel * static_cast<std::ptrdiff_t>(width);
            const T* w = weights + ((channel * C.kernel.rows + row_kernel_first + row * C.spacing.rows) *
                                        C.kernel.columns +
                                    Columns.first) *
                                       Channels;
            if constexpr (Outputs > 1) {
#pragma GCC unroll 64
                for (std::size_t tap = 0; tap < Columns.taps; ++tap)
                    add_tap<C, Columns>(sums, from, w, tap);
            } else {
                for (std::size_t tap = first_tap; tap < last_tap; ++tap)
                    add_tap<C, Columns>(sums, from, w, tap);
            }
        }
    }
#pragma GCC unroll 64
    for (std::size_t c = 0; c < Channels; ++c) {
#pragma GCC unroll 64
        for (std::size_t o = 0; o < Outputs; ++o)
            store(output + c * C.output.area() * width + o * output_step, sums[c][o]);
    }
}

/// Direct convolution: one multiply-add for each tap on a pixel.
template <batch_convolution C, class T>
struct direct_lane_method {
    static constexpr const char* name = "direct";
    static constexpr bool applicable = C.groups == 1;
    /// In halves of a multiply-add.
    static constexpr std::size_t half_products = direct_cost(C);
    static constexpr std::size_t packed_elements = C.weights();
    static constexpr std::size_t workspace_elements = 0;

    /// Packs blocks of output channels, each [input channel][kernel row][kernel column][channel of the
    /// block]. `weight(output, input, row, column)` returns one weight.
    template <class Weight>
    static void pack(const Weight& weight, T* to) {
        pack_taps(weight, C.output.channels, C.output.channels, block_channels, C.input.channels, C.kernel,
                  to);
    }

    /// output = bias + convolution of the input. `bias` may be null.
    [[gnu::flatten]] static void run(const T* packed, const T* bias, const T* input, T* output, T*) {
        constexpr std::size_t width = lanes<T>;
        blocked<C.output.channels, block_channels>([&](auto channels, std::size_t first_channel) {
            const T* weights = packed + first_channel * C.input.channels * C.kernel.area();
            const T* block_bias = bias ? bias + first_channel : nullptr;
            T* block_output = output + first_channel * C.output.area() * width;
            for (std::size_t y = 0; y < C.output.rows; ++y) {
                const tap_axis rows = C.row_axis(y % C.spacing.rows);
                const std::size_t line = y / C.spacing.rows;
                unroll<C.spacing.columns>([&](auto phase) {
                    constexpr tap_axis columns = C.column_axis(phase);
                    const auto block = [&](auto outputs, std::size_t index, std::size_t first,
                                           std::size_t last) {
                        const std::size_t x = phase + index * C.spacing.columns;
                        correlate_block<C, columns, outputs, channels>(
                            input, weights, block_bias, block_output + (y * C.output.columns + x) * width,
                            rows.position(line), rows.first_tap(line), rows.last_tap(line), rows.first, index,
                            first, last);
                    };
                    constexpr std::size_t begin = columns.interior_begin(), end = columns.interior_end();
                    const auto edge = [&](std::size_t i) {
                        block(constant<1>{}, i, columns.first_tap(i), columns.last_tap(i));
                    };
                    for (std::size_t i = 0; i < begin; ++i)
                        edge(i);
                    blocked<end - begin, block_outputs>(
                        [&](auto outputs, std::size_t i) { block(outputs, begin + i, 0, columns.taps); });
                    for (std::size_t i = end; i < columns.outputs; ++i)
                        edge(i);
                });
            }
        });
    }
};

}}} // namespace tactnet::kernels
