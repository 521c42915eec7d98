#pragma once

#include <tactnet/kernels/frame/convolution.hpp>
#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/kernels/frame/pooling.hpp>
#include <tactnet/kernels/frame/winograd.hpp>
#include <tactnet/kernels/rows/softmax.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

// What a deployed network does, step by step. A step stands for one or several layers, and knows sizes only.
// Its constants:
//   output, output_stride   the map it writes, pixel by pixel, and elements from one pixel to the next
//   folded                  numbers that remain of the layers' parameters once batch norms are folded in
//                           ([output][channel][row][column], then biases)
//   packed                  the same in the order of use, padded to whole vectors
//   scratch                 elements of memory it needs while it runs
// and its functions:
//   pack                    from folded to packed numbers, into zeros; usable at compile time
//   run                     from one map to the next
//   reach                   the largest magnitude that an output can have where inputs have at most `input`
// Lanes behind the last channel of a pixel hold zeros in every map.
//
// This header and those below it need neither exceptions nor run-time type information nor files.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// For [output][weights of one], then biases: the largest |bias| + input · Σ |weight|.
[[nodiscard]] inline double largest_sum(const float* weights, std::size_t outputs, std::size_t of_one,
                                        double input) {
    double most = 0;
    for (std::size_t o = 0; o < outputs; ++o) {
        double sum = 0;
        for (std::size_t i = 0; i < of_one; ++i)
            sum += std::abs(static_cast<double>(weights[o * of_one + i]));
        most = std::max(most, sum * input + std::abs(static_cast<double>(weights[outputs * of_one + o])));
    }
    return most;
}

} // namespace detail

/// Convolution with what follows it: batch norm, a sum, max pool, ReLU.
template <kernels::frame_convolution Kernel>
struct convolution_step {
    static constexpr kernels::frame_convolution kernel = Kernel;
    static constexpr shape output{Kernel.output_rows(), Kernel.output_columns(), Kernel.filters};
    static constexpr std::size_t output_stride = Kernel.output_stride();
    static constexpr std::size_t weights = Kernel.filters * Kernel.taps();
    static constexpr std::size_t folded = weights + Kernel.filters;
    /// Whether tiles take fewer operations than taps.
    static constexpr bool tiled = kernels::winograd_tiles<Kernel>::pays;
    static constexpr std::size_t packed_weights =
        whole_lines(tiled ? kernels::winograd_tiles<Kernel>::weights : Kernel.weights());
    static constexpr std::size_t packed = packed_weights + whole_lines(output_stride);
    static constexpr std::size_t scratch = tiled ? kernels::winograd_tiles<Kernel>::scratch : 0;

    static constexpr void pack(const float* from, float* to) {
        const auto weight = [&](std::size_t filter, std::size_t channel, std::size_t row,
                                std::size_t column) {
            constexpr extent k = Kernel.window.kernel;
            return from[((filter * Kernel.window.input.channels + channel) * k.rows + row) * k.columns +
                        column];
        };
        if constexpr (tiled)
            kernels::pack_winograd_weights<Kernel>(to, weight);
        else
            kernels::pack_frame_weights<Kernel>(to, weight);
        std::copy_n(from + weights, Kernel.filters, to + packed_weights);
    }
    static double reach(const float* from, double input) {
        return detail::largest_sum(from, Kernel.filters, Kernel.taps(), input);
    }
    static void run(const float* packed_values, const float* in, float* out,
                    [[maybe_unused]] float* memory) noexcept {
        if constexpr (tiled)
            kernels::convolve_frame_by_tiles<Kernel>(in, packed_values, packed_values + packed_weights, out,
                                                     memory);
        else
            kernels::convolve_frame<Kernel>(in, packed_values, packed_values + packed_weights, out);
    }
};

/// A batch norm that follows no convolution, with or without ReLU: a factor and an offset for each channel.
template <shape Map, std::size_t Stride, bool Rectified>
struct norm_step {
    static constexpr shape output = Map;
    static constexpr std::size_t output_stride = Stride;
    static constexpr std::size_t folded = 2 * Map.channels, packed = 2 * whole_lines(Stride);
    static constexpr std::size_t scratch = 0;

    static constexpr void pack(const float* from, float* to) {
        std::copy_n(from, Map.channels, to);
        std::copy_n(from + Map.channels, Map.channels, to + whole_lines(Stride));
    }
    static double reach(const float* from, double input) {
        return detail::largest_sum(from, Map.channels, 1, input);
    }
    static void run(const float* factors, const float* in, float* out, float*) noexcept {
        const float* offsets = factors + whole_lines(Stride);
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; ++c) {
                const float y = in[pixel + c] * factors[c] + offsets[c];
                out[pixel + c] = Rectified && y < 0 ? 0 : y;
            }
    }
};

/// What steps without parameters have in common.
template <shape Output, std::size_t Stride>
struct step_without_parameters {
    static constexpr shape output = Output;
    static constexpr std::size_t output_stride = Stride;
    static constexpr std::size_t folded = 0, packed = 0, scratch = 0;
    static constexpr void pack(const float*, float*) {}
    static double reach(const float*, double input) { return input; }
};

template <shape Map, std::size_t Stride>
struct relu_step : step_without_parameters<Map, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        for (std::size_t e = 0; e < Map.area() * Stride; ++e)
            out[e] = in[e] < 0 ? 0 : in[e];
    }
};

template <sliding_window Window, std::size_t Stride>
struct pool_step
    : step_without_parameters<shape{Window.output_rows(), Window.output_columns(), Window.input.channels},
                              Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::pool_frame<Window, Stride>(in, out);
    }
};

template <shape Map, std::size_t Stride>
struct softmax_step : step_without_parameters<Map, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride) {
            kernels::softmax_of<float>(std::span(in + pixel, Map.channels),
                                       std::span(out + pixel, Map.channels));
            std::fill(out + pixel + Map.channels, out + pixel + Stride, 0.0f);
        }
    }
};

template <kernels::frame_dense Kernel>
struct dense_step {
    static constexpr kernels::frame_dense kernel = Kernel;
    static constexpr shape output{1, 1, Kernel.outputs};
    static constexpr std::size_t output_stride = Kernel.output_stride();
    static constexpr std::size_t weights = Kernel.outputs * Kernel.input.size();
    static constexpr std::size_t folded = weights + Kernel.outputs;
    static constexpr std::size_t packed_weights = whole_lines(Kernel.weights());
    static constexpr std::size_t packed = packed_weights + whole_lines(output_stride);
    static constexpr std::size_t scratch = 0;

    static constexpr void pack(const float* from, float* to) {
        kernels::pack_dense_weights<Kernel>(to, [&](std::size_t o, std::size_t channel, std::size_t pixel) {
            return from[(o * Kernel.input.channels + channel) * Kernel.input.area() + pixel];
        });
        std::copy_n(from + weights, Kernel.outputs, to + packed_weights);
    }
    static double reach(const float* from, double input) {
        return detail::largest_sum(from, Kernel.outputs, Kernel.input.size(), input);
    }
    static void run(const float* packed_values, const float* in, float* out, float*) noexcept {
        kernels::multiply_frame<Kernel>(in, packed_values, packed_values + packed_weights, out);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
