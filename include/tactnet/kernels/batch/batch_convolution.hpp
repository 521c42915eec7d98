#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The outputs along rows or columns that share a phase: index = phase + spacing × i. Tap t of output i reads
/// the input at base + i × step + t, with kernel index first + spacing × t.
struct tap_axis {
    std::size_t outputs;
    std::size_t taps;
    std::size_t first;
    std::ptrdiff_t base;
    std::size_t step;
    std::ptrdiff_t input;

    static constexpr tap_axis of(std::size_t output, std::size_t kernel, std::size_t stride,
                                 std::size_t spacing, std::ptrdiff_t before, std::size_t input,
                                 std::size_t phase) {
        const auto gap = static_cast<std::ptrdiff_t>(spacing);
        const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(phase * stride) - before;
        const std::size_t first = static_cast<std::size_t>(((-start) % gap + gap) % gap);
        return {.outputs = output > phase ? ceil_div(output - phase, spacing) : 0,
                .taps = kernel > first ? ceil_div(kernel - first, spacing) : 0,
                .first = first,
                .base = (start + static_cast<std::ptrdiff_t>(first)) / gap,
                .step = spacing == 1 ? stride : 1,
                .input = static_cast<std::ptrdiff_t>(input)};
    }
    [[nodiscard]] constexpr std::ptrdiff_t position(std::size_t i) const {
        return base + static_cast<std::ptrdiff_t>(i * step);
    }
    /// Taps [first_tap, last_tap) of output i are on pixels, the others on padding.
    [[nodiscard]] constexpr std::size_t first_tap(std::size_t i) const { return clamped(-position(i)); }
    [[nodiscard]] constexpr std::size_t last_tap(std::size_t i) const { return clamped(input - position(i)); }
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
    /// The taps of all outputs that are on pixels.
    [[nodiscard]] constexpr std::size_t taps_on_pixels() const {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < outputs; ++i)
            sum += std::max(last_tap(i), first_tap(i)) - first_tap(i);
        return sum;
    }

private:
    [[nodiscard]] constexpr std::size_t clamped(std::ptrdiff_t tap) const {
        return static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(tap, 0, static_cast<std::ptrdiff_t>(taps)));
    }
};

/// The convolution of one lane block (see tensor/batch.hpp): sizes and geometry. `spacing` > 1 reads the
/// input as if spacing − 1 zeros stood between its pixels: with it, the input gradient of a strided
/// convolution is a convolution again. Groups lie one after the other, in maps and in weights.
struct batch_convolution {
    shape input;
    shape output;
    extent2d kernel;
    extent2d stride;
    extent2d spacing;
    std::ptrdiff_t top;
    std::ptrdiff_t left;
    std::size_t groups = 1;

    [[nodiscard]] static constexpr batch_convolution forward(const sliding_window& w, std::size_t filters,
                                                             std::size_t groups = 1) {
        return {w.input,
                {w.output_rows(), w.output_columns(), filters},
                w.kernel,
                w.stride,
                1,
                static_cast<std::ptrdiff_t>(w.top),
                static_cast<std::ptrdiff_t>(w.left),
                groups};
    }
    /// The input gradient from the output gradient: the kernel rotated by 180°, channels and filters
    /// exchanged.
    [[nodiscard]] static constexpr batch_convolution backward(const sliding_window& w, std::size_t filters,
                                                              std::size_t groups = 1) {
        return {{w.output_rows(), w.output_columns(), filters},
                w.input,
                w.kernel,
                1,
                w.stride,
                static_cast<std::ptrdiff_t>(w.kernel.rows) - 1 - static_cast<std::ptrdiff_t>(w.top),
                static_cast<std::ptrdiff_t>(w.kernel.columns) - 1 - static_cast<std::ptrdiff_t>(w.left),
                groups};
    }

    [[nodiscard]] constexpr batch_convolution one_group() const {
        batch_convolution one = *this;
        one.input.channels /= groups, one.output.channels /= groups, one.groups = 1;
        return one;
    }
    /// Whether each channel has one filter of its own: a depthwise convolution without a multiplier.
    [[nodiscard]] constexpr bool one_filter_per_channel() const {
        return groups == input.channels && groups == output.channels;
    }
    [[nodiscard]] constexpr std::size_t weights() const {
        return output.channels * (input.channels / groups) * kernel.area();
    }
    [[nodiscard]] constexpr tap_axis row_axis(std::size_t phase = 0) const {
        return tap_axis::of(output.rows, kernel.rows, stride.rows, spacing.rows, top, input.rows, phase);
    }
    [[nodiscard]] constexpr tap_axis column_axis(std::size_t phase = 0) const {
        return tap_axis::of(output.columns, kernel.columns, stride.columns, spacing.columns, left,
                            input.columns, phase);
    }
    friend constexpr bool operator==(const batch_convolution&, const batch_convolution&) = default;
};

}}} // namespace tactnet::kernels
