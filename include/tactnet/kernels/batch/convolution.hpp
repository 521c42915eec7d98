#pragma once

#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Convolution of one group of samples (see tensor/batch.hpp). A block of neighbouring outputs × output
// channels stays in registers while all taps are added; taps on padding are never visited. The sum of one
// output runs over channel, kernel row and kernel column in this order, whatever the blocking, so results do
// not depend on it.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// What a convolution reads and writes. `spacing` > 1 reads the input as if spacing − 1 zeros stood between
/// its pixels: with it, the gradient of a strided convolution is a convolution again.
struct batch_convolution {
    shape input;
    shape output;
    extent2d kernel;
    extent2d stride;
    extent2d spacing;
    std::ptrdiff_t top;
    std::ptrdiff_t left;

    [[nodiscard]] static constexpr batch_convolution forward(const sliding_window& w, std::size_t filters) {
        return {w.input,
                {w.output_rows(), w.output_columns(), filters},
                w.kernel,
                w.stride,
                1,
                static_cast<std::ptrdiff_t>(w.top),
                static_cast<std::ptrdiff_t>(w.left)};
    }
    /// The gradient with respect to the input, from that of the output: kernel turned by 180°, channels
    /// exchanged.
    [[nodiscard]] static constexpr batch_convolution backward(const sliding_window& w, std::size_t filters) {
        return {{w.output_rows(), w.output_columns(), filters},
                w.input,
                w.kernel,
                1,
                w.stride,
                static_cast<std::ptrdiff_t>(w.kernel.rows) - 1 - static_cast<std::ptrdiff_t>(w.top),
                static_cast<std::ptrdiff_t>(w.kernel.columns) - 1 - static_cast<std::ptrdiff_t>(w.left)};
    }
    friend constexpr bool operator==(const batch_convolution&, const batch_convolution&) = default;
};

/// The outputs of one direction (rows or columns) that share a phase: index = phase + spacing × i. Tap t of
/// output i reads the input at base + i × step + t, with kernel index first + spacing × t.
struct tap_line {
    std::size_t outputs;
    std::size_t taps;
    std::size_t first;
    std::ptrdiff_t base;
    std::size_t step;
    std::ptrdiff_t input;

    static constexpr tap_line of(std::size_t output, std::size_t kernel, std::size_t stride,
                                 std::size_t spacing, std::ptrdiff_t before, std::size_t input,
                                 std::size_t phase) {
        const auto gap = static_cast<std::ptrdiff_t>(spacing);
        const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(phase * stride) - before;
        const std::size_t first = static_cast<std::size_t>(((-start) % gap + gap) % gap);
        return {.outputs = output > phase ? (output - phase + spacing - 1) / spacing : 0,
                .taps = kernel > first ? (kernel - first + spacing - 1) / spacing : 0,
                .first = first,
                .base = (start + static_cast<std::ptrdiff_t>(first)) / gap,
                .step = spacing == 1 ? stride : 1,
                .input = static_cast<std::ptrdiff_t>(input)};
    }
    [[nodiscard]] constexpr std::ptrdiff_t position(std::size_t i) const {
        return base + static_cast<std::ptrdiff_t>(i * step);
    }
    [[nodiscard]] constexpr std::size_t first_tap(std::size_t i) const {
        return static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(-position(i), 0, static_cast<std::ptrdiff_t>(taps)));
    }
    [[nodiscard]] constexpr std::size_t last_tap(std::size_t i) const {
        return static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(input - position(i), 0, static_cast<std::ptrdiff_t>(taps)));
    }
    /// Outputs [interior_begin, interior_end) have all taps on pixels.
    [[nodiscard]] constexpr std::size_t interior_begin() const {
        std::size_t i = 0;
        while (i < outputs && first_tap(i) > 0)
            ++i;
        return i;
    }
    [[nodiscard]] constexpr std::size_t interior_end() const {
        std::size_t i = outputs;
        while (i > interior_begin() && last_tap(i - 1) < taps)
            --i;
        return i;
    }
};

/// Output channels × neighbouring outputs of a register block: accumulators, the inputs and a weight must
/// fit.
inline constexpr std::size_t block_channels = vector_registers == 32 ? 8 : 4;
inline constexpr std::size_t block_outputs = 3;

/// Weights in the order of use: blocks of output channels, then [input channel][kernel row][kernel
/// column][channel of the block]. `weight(output, input, row, column)` tells each value.
template <batch_convolution C, class T, class Weight>
void pack_weights(T* packed, Weight&& weight) {
    for (std::size_t first = 0; first < C.output.channels; first += block_channels) {
        const std::size_t count = std::min(block_channels, C.output.channels - first);
        for (std::size_t input = 0; input < C.input.channels; ++input)
            for (std::size_t row = 0; row < C.kernel.rows; ++row)
                for (std::size_t column = 0; column < C.kernel.columns; ++column)
                    for (std::size_t channel = 0; channel < count; ++channel)
                        *packed++ = weight(first + channel, input, row, column);
    }
}

/// Adds one tap to a register block.
template <batch_convolution C, tap_line Columns, std::size_t Outputs, std::size_t Channels, class T>
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
template <batch_convolution C, tap_line Columns, std::size_t Outputs, std::size_t Channels, class T>
[[gnu::always_inline]] inline void
correlate_block(const T* input, const T* weights, const T* bias, T* output, std::ptrdiff_t row_position,
                std::size_t first_row, std::size_t last_row, std::size_t row_kernel_first, std::size_t index,
                std::size_t first_tap, std::size_t last_tap) {
    constexpr std::size_t width = lanes<T>;
    constexpr std::size_t output_step =
        (Columns.step == 1 && C.stride.columns == 1 ? C.spacing.columns : 1) * width;
    std::array<std::array<vector<T>, Outputs>, Channels> sums;
#pragma GCC unroll 64
    for (std::size_t c = 0; c < Channels; ++c) {
        const vector<T> start(bias ? bias[c] : T{});
#pragma GCC unroll 64
        for (std::size_t o = 0; o < Outputs; ++o)
            sums[c][o] = start;
    }
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

/// output = bias + convolution of input and weights, for one group. `bias` may be null.
template <batch_convolution C, class T>
[[gnu::flatten]] void correlate(const T* input, const T* packed_weights, const T* bias, T* output) {
    constexpr std::size_t width = lanes<T>;
    blocked<C.output.channels, block_channels>([&](auto channels, std::size_t first_channel) {
        const T* weights = packed_weights + first_channel * C.input.channels * C.kernel.area();
        const T* block_bias = bias ? bias + first_channel : nullptr;
        T* block_output = output + first_channel * C.output.area() * width;
        for (std::size_t y = 0; y < C.output.rows; ++y) {
            const tap_line rows = tap_line::of(C.output.rows, C.kernel.rows, C.stride.rows, C.spacing.rows,
                                               C.top, C.input.rows, y % C.spacing.rows);
            const std::size_t line = y / C.spacing.rows;
            unroll<C.spacing.columns>([&](auto phase) {
                constexpr tap_line columns =
                    tap_line::of(C.output.columns, C.kernel.columns, C.stride.columns, C.spacing.columns,
                                 C.left, C.input.columns, phase);
                const auto block = [&](auto outputs, std::size_t index, std::size_t first, std::size_t last) {
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

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
