#pragma once

// Convolutions of frames on random numbers, held to the bound of their errors, between guards that must stay
// untouched.

#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/operators/activations/function.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <support/guarded_map.hpp>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/window_of.hpp>
#include <vector>

namespace support {

constexpr tactnet::kernels::frame_convolution step(tactnet::shape in, tactnet::extent2d kernel,
                                                   std::size_t filters, std::size_t input_stride,
                                                   tactnet::extent2d stride = 1,
                                                   tactnet::padding around = tactnet::padding::same) {
    return {.window = tactnet::sliding_window::over(in, kernel, stride, around),
            .filters = filters,
            .input_stride = input_stride};
}
constexpr tactnet::kernels::frame_convolution with_relu(tactnet::kernels::frame_convolution c) {
    c.activation = tactnet::fused<tactnet::relu_function>;
    return c;
}
constexpr tactnet::kernels::frame_convolution adding(tactnet::kernels::frame_convolution c,
                                                     bool relu = false) {
    c.accumulates = true,
    c.activation = relu ? tactnet::fused<tactnet::relu_function> : &tactnet::kernels::no_activation;
    return c;
}
/// Behind it a max pool of windows side by side; `whole` leaves out windows that the image does not fill.
constexpr tactnet::kernels::frame_convolution pooled(tactnet::kernels::frame_convolution c,
                                                     tactnet::extent2d pool, bool whole = false) {
    const std::size_t rows = c.window.output_rows(), columns = c.window.output_columns();
    c.pool = pool, c.activation = tactnet::fused<tactnet::relu_function>;
    c.pooled_rows = whole ? rows / pool.rows : (rows + pool.rows - 1) / pool.rows;
    c.pooled_columns = whole ? columns / pool.columns : (columns + pool.columns - 1) / pool.columns;
    return c;
}

/// The numbers of a convolution of one frame or several. They do not depend on the method, so that all of
/// this is compiled once for all convolutions of a test.
struct convolution_numbers {
    tactnet::kernels::frame_convolution c;
    std::size_t frames;
    std::vector<double> weights;
    std::vector<float> bias;
    std::vector<sample> inputs, added; ///< of each frame
    std::size_t input_distance, output_distance;
    guarded_map laid_inputs;

    /// Lanes after the channels of the input hold `rest`, as other steps may leave them; around the maps is
    /// NaN.
    convolution_numbers(const tactnet::kernels::frame_convolution& convolution, std::size_t count,
                        std::uint64_t seed, float rest = 1e3f)
        : c(convolution),
          frames(count),
          weights(c.filters * c.taps()),
          bias(c.filters),
          inputs(count, sample(c.window.input.size())),
          added(count),
          input_distance(tactnet::pad_to_cache_line(input_size())),
          output_distance(tactnet::pad_to_cache_line(output_size())),
          laid_inputs((count - 1) * input_distance + input_size(), NAN, rest) {
        std::uint64_t state = seed;
        const auto next = [&] { return static_cast<double>(draw(state)); };
        std::generate(weights.begin(), weights.end(), next);
        std::generate(bias.begin(), bias.end(), [&] { return draw(state); });
        const std::size_t pixels = c.window.input.area();
        for (std::size_t frame = 0; frame < frames; ++frame) {
            for (std::size_t channel = 0; channel < c.window.input.channels; ++channel)
                for (std::size_t p = 0; p < pixels; ++p) {
                    const double value = next();
                    inputs[frame][channel * pixels + p].value = value;
                    laid_inputs.data()[frame * input_distance + p * c.input_stride + channel] =
                        static_cast<float>(value);
                }
            if (c.accumulates) {
                added[frame].resize(c.filters * area());
                for (bounded& a : added[frame])
                    a.value = next();
            }
        }
    }
    /// Elements of one map.
    [[nodiscard]] std::size_t input_size() const { return c.window.input.area() * c.input_stride; }
    [[nodiscard]] std::size_t output_size() const { return area() * c.output_stride(); }
    [[nodiscard]] std::size_t area() const { return c.output_rows() * c.output_columns(); }
    /// By filter, channel of its group, row and column.
    [[nodiscard]] auto weight() const {
        return [this](std::size_t f, std::size_t channel, std::size_t row, std::size_t column) {
            const tactnet::extent2d k = c.window.kernel;
            const std::size_t channels = c.window.input.channels / c.groups;
            if (channel >= channels)
                throw std::out_of_range("a weight of another group");
            return static_cast<float>(
                weights[((f * channels + channel) * k.rows + row) * k.columns + column]);
        };
    }
    /// Output maps before a run: the other terms of the sums, or NaN.
    [[nodiscard]] guarded_map fresh_outputs() const {
        guarded_map maps((frames - 1) * output_distance + output_size(), 12345, c.accumulates ? 0.0f : NAN);
        for (std::size_t frame = 0; frame < frames && c.accumulates; ++frame)
            for (std::size_t f = 0; f < c.filters; ++f)
                for (std::size_t p = 0; p < area(); ++p)
                    maps.data()[frame * output_distance + p * c.output_stride() + c.map_offset + f] =
                        static_cast<float>(added[frame][f * area() + p].value);
        return maps;
    }
    /// The output map of the first frame as a method leaves it.
    template <class Method>
    [[nodiscard]] std::vector<float> run() {
        guarded_map packed(Method::packed_elements, 4321, 0), memory(Method::workspace_elements, 54321, NAN),
            output = fresh_outputs();
        Method::pack(weight(), bias.data(), packed.data());
        Method::run(packed.data(), laid_inputs.data(), output.data(), memory.data());
        CHECK(packed.untouched());
        CHECK(memory.untouched());
        CHECK(output.untouched());
        return {output.data(), output.data() + output_size()};
    }
    /// The exact outputs of a frame [filter][pixel] with their bounds, if computed by such tiles.
    [[nodiscard]] sample expected(std::size_t frame, tactnet::extent2d tile) const {
        sample biases(c.filters);
        for (std::size_t f = 0; f < c.filters; ++f)
            biases[f].value = static_cast<double>(bias[f]);
        return pooled_and_rectified(c, bounded_convolution(window_of(c.window), c.filters, weights, biases,
                                                           inputs[frame],
                                                           c.accumulates ? &added[frame] : nullptr,
                                                           {tile.rows, tile.columns}, c.groups));
    }
    /// Outputs of a frame that are further from the exact ones than the bound, or not clean where there is no
    /// filter.
    [[nodiscard]] std::size_t wrong_outputs(std::size_t frame, const float* found,
                                            tactnet::extent2d tile) const {
        const sample exact = expected(frame, tile);
        return (exact.size() != area() * c.filters) +
               outputs_outside(exact, area(), found + frame * output_distance, c.output_stride());
    }
    /// Holds a method to the bound.
    template <class Method>
    void check() {
        CAPTURE(c.window.input.rows);
        CAPTURE(c.window.input.columns);
        CAPTURE(c.window.input.channels);
        CAPTURE(c.filters);
        CHECK(wrong_outputs(0, run<Method>().data(), Method::tile) == 0);
    }
};

} // namespace support
