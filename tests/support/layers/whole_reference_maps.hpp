#pragma once

// What steps in 8 bits must give that give a map another size. whole_reference.hpp includes it.

#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/operators/dilated_convolution/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <support/layers/reference.hpp>
#include <support/layers/whole_reference.hpp>

namespace support {

template <tactnet::shape Input, tactnet::extent2d Output, std::size_t Stride>
struct reference_step<tactnet::adaptive_max_pool_step<tactnet::eight_bit, Input, Output, Stride>> {
    static whole_map run(const float*, const whole_map& in, const whole_map&) {
        return exact_layer(
            reference_adaptive_max({Input.channels, Input.rows, Input.columns}, Output.rows, Output.columns),
            in);
    }
};

/// Sums of steps times whole parts of a pixel, times 1 ÷ all parts in single precision.
template <tactnet::interpolation Mode, tactnet::shape Input, tactnet::extent2d Output, std::size_t Stride>
struct reference_step<tactnet::resampling_step<tactnet::eight_bit, Mode, Input, Output, Stride>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        constexpr bool linear = Mode == tactnet::interpolation::bilinear;
        const reference_pointer layer = reference_upsampling({Input.channels, Input.rows, Input.columns},
                                                             Output.rows, Output.columns, linear);
        if (!linear)
            return exact_layer(layer, in);
        // Outputs lie at multiples of 1 ÷ parts of a pixel.
        const auto parts = [](std::size_t from, std::size_t to) { return 2 * to / std::gcd(from, to); };
        const auto all =
            static_cast<float>(parts(Input.rows, Output.rows) * parts(Input.columns, Output.columns));
        const std::int64_t zero = reference_range::next(folded).zero;
        return each_number(
            exact_layer(layer, in, zero, static_cast<double>(all)),
            [&](std::int64_t sum, std::size_t) { return reference_byte(sum, 1 / all, zero, false); });
    }
};

/// The phases of a transposed convolution: each pixel holds stride × stride pixels of the output.
template <class Format, tactnet::shape Map, tactnet::extent2d Stride, tactnet::extent2d Skipped,
          tactnet::extent2d Output, std::size_t InputStride>
struct reference_step<tactnet::phase_interleaving_step<Format, Map, Stride, Skipped, Output, InputStride>> {
    static whole_map run(const float*, const whole_map& in, const whole_map&) {
        const std::size_t filters = Map.channels / Stride.area();
        whole_map result(tactnet::shape{Output.rows, Output.columns, filters});
        for (std::size_t i = 0; i < result.whole.size(); ++i) {
            const std::size_t c = i % filters, x = i / filters % Output.columns + Skipped.columns,
                              y = i / filters / Output.columns + Skipped.rows;
            const std::size_t phase = y % Stride.rows * Stride.columns + x % Stride.columns;
            result.whole[i] = in.whole[in.at(y / Stride.rows, x / Stride.columns, phase * filters + c)];
        }
        return result;
    }
};

/// The phases of a dilated convolution, and the byte of zero between them.
template <tactnet::sliding_window Window, tactnet::extent2d Dilation, tactnet::extent2d Outputs,
          std::size_t InputStride>
struct reference_step<
    tactnet::phase_splitting_step<tactnet::eight_bit, Window, Dilation, Outputs, InputStride>> {
    using phases = tactnet::kernels::dilated_phases<Window, Dilation, Outputs>;
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        whole_map result(phases::map);
        constexpr tactnet::sliding_window of_phases = phases::window;
        std::fill(result.whole.begin(), result.whole.end(), reference_range::next(folded).zero);
        // Each tap of each output has the pixel under it that the definition says.
        for (std::size_t y = 0; y < Outputs.rows; ++y)
            for (std::size_t x = 0; x < Outputs.columns; ++x)
                for (std::size_t tap = 0; tap < Window.kernel.area(); ++tap) {
                    const std::size_t i = tap / Window.kernel.columns, j = tap % Window.kernel.columns,
                                      row = y * Window.stride.rows + i * Dilation.rows,
                                      column = x * Window.stride.columns + j * Dilation.columns;
                    if (row < Window.top || row - Window.top >= in.rows || column < Window.left ||
                        column - Window.left >= in.columns)
                        continue;
                    const std::size_t sum = phases::layout.sum_of(y, x), sums = of_phases.output_columns(),
                                      to_row = sum / sums * of_phases.stride.rows + i - of_phases.top,
                                      to_column = sum % sums * of_phases.stride.columns + j - of_phases.left;
                    for (std::size_t c = 0; c < in.channels; ++c)
                        result.whole[result.at(to_row, to_column, c)] =
                            in.whole[in.at(row - Window.top, column - Window.left, c)];
                }
        return result;
    }
};
template <class Format, tactnet::sliding_window Window, tactnet::extent2d Dilation, tactnet::extent2d Outputs,
          std::size_t Filters, std::size_t InputStride>
struct reference_step<tactnet::phase_merging_step<Format, Window, Dilation, Outputs, Filters, InputStride>> {
    using phases = tactnet::kernels::dilated_phases<Window, Dilation, Outputs>;
    static whole_map run(const float*, const whole_map& in, const whole_map&) {
        whole_map result(tactnet::shape{Outputs.rows, Outputs.columns, Filters});
        for (std::size_t i = 0; i < result.whole.size(); ++i)
            result.whole[i] =
                in.whole[phases::layout.sum_of(i / Filters / Outputs.columns, i / Filters % Outputs.columns) *
                             Filters +
                         i % Filters];
        return result;
    }
};

} // namespace support
