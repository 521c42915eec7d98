#pragma once

#include <tactnet/kernels/panels/large_convolution.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/window_of.hpp>
#include <utility>
#include <vector>

// A large convolution of one frame or several on random numbers, held to the bound of its error, between
// guards that must stay untouched.

namespace support {

/// Sizes that come in whole vectors whatever the instruction set.
inline constexpr std::size_t several_lanes = 2 * tactnet::kernels::lanes<float>;

struct large_numbers {
    tactnet::kernels::frame_convolution c;
    std::size_t frames;
    std::vector<double> weights;
    std::vector<bounded> biases;
    std::vector<sample> inputs, added; ///< of each frame
    std::size_t input_distance, output_distance;
    guarded_map laid_inputs;

    large_numbers(const tactnet::kernels::frame_convolution& convolution, std::size_t count,
                  std::uint64_t seed)
        : c(convolution),
          frames(count),
          weights(c.filters * c.taps()),
          biases(c.filters),
          inputs(count, sample(c.window.input.size())),
          added(count),
          input_distance(tactnet::pad_to_cache_line(c.window.input.area() * c.input_stride)),
          output_distance(
              tactnet::pad_to_cache_line(c.output_rows() * c.output_columns() * c.output_stride())),
          // Lanes beyond the channels hold numbers, as other steps may leave them; around the maps is NaN.
          laid_inputs(count * input_distance, NAN, 1e3f) {
        std::uint64_t state = seed;
        const auto next = [&] { return static_cast<double>(draw(state)); };
        std::generate(weights.begin(), weights.end(), next);
        for (bounded& b : biases)
            b.value = next();
        const std::size_t area = c.window.input.area();
        for (std::size_t frame = 0; frame < frames; ++frame) {
            for (std::size_t channel = 0; channel < c.window.input.channels; ++channel)
                for (std::size_t p = 0; p < area; ++p) {
                    const double value = next();
                    inputs[frame][channel * area + p].value = value;
                    laid_inputs.data()[frame * input_distance + p * c.input_stride + channel] =
                        static_cast<float>(value);
                }
            if (c.accumulates) {
                added[frame].resize(c.filters * c.output_rows() * c.output_columns());
                for (bounded& a : added[frame])
                    a.value = next();
            }
        }
    }
    [[nodiscard]] float weight(std::size_t f, std::size_t channel, std::size_t row,
                               std::size_t column) const {
        const tactnet::extent2d k = c.window.kernel;
        return static_cast<float>(
            weights[((f * c.window.input.channels + channel) * k.rows + row) * k.columns + column]);
    }
    /// Output maps before a run: the other terms of the sums, or NaN.
    [[nodiscard]] std::vector<float> fresh_outputs() const {
        std::vector<float> maps(frames * output_distance, c.accumulates ? 0.0f : NAN);
        const std::size_t area = c.output_rows() * c.output_columns();
        for (std::size_t frame = 0; frame < frames && c.accumulates; ++frame)
            for (std::size_t f = 0; f < c.filters; ++f)
                for (std::size_t p = 0; p < area; ++p)
                    maps[frame * output_distance + p * c.output_stride() + f] =
                        static_cast<float>(added[frame][f * area + p].value);
        return maps;
    }
    /// Output maps as all shares of `threads` leave them, one after the other.
    [[nodiscard]] std::vector<float> run(std::size_t threads, std::size_t workspaces = 1) {
        const tactnet::kernels::large_convolution plan(c);
        guarded_map packed(plan.weights(), 4321, 0), memory(workspaces * plan.workspace(), 54321, NAN),
            bias(c.padded_filters(), NAN, 0), output(frames * output_distance, 12345, NAN);
        for (std::size_t f = 0; f < c.filters; ++f)
            bias.data()[f] = static_cast<float>(biases[f].value);
        plan.pack([&](std::size_t f, std::size_t channel, std::size_t row,
                      std::size_t column) { return weight(f, channel, row, column); },
                  packed.data());
        const std::vector<float> before = fresh_outputs();
        std::copy(before.begin(), before.end(), output.data());
        for (std::size_t thread = 0; thread < threads; ++thread)
            convolve_large(plan, {frames, input_distance, output_distance, {thread, threads}, workspaces},
                           laid_inputs.data(), packed.data(), bias.data(), output.data(), memory.data());
        CHECK(packed.untouched());
        CHECK(memory.untouched());
        CHECK(output.untouched());
        return {output.data(), output.data() + frames * output_distance};
    }
    /// Outputs of a frame that are further from the exact ones than the bound, or not clean where there is no
    /// filter.
    [[nodiscard]] std::size_t wrong_outputs(std::size_t frame, const float* found) const {
        const std::size_t tiles = tactnet::kernels::large_convolution(c).tiles.outputs;
        const sample expected = pooled_and_rectified(
            c, bounded_convolution(window_of(c.window), c.filters, weights, biases, inputs[frame],
                                   c.accumulates ? &added[frame] : nullptr, {tiles, tiles}));
        const std::size_t area = c.output_rows() * c.output_columns();
        return (expected.size() != area * c.filters) +
               outputs_outside(expected, area, found + frame * output_distance, c.output_stride());
    }
};

/// One frame, held to the bound.
inline void compare_large(const tactnet::kernels::frame_convolution& c, std::size_t tile_outputs,
                          std::uint64_t seed) {
    CAPTURE(c.window.input.rows);
    CAPTURE(c.window.input.columns);
    CAPTURE(c.window.input.channels);
    CAPTURE(c.filters);
    REQUIRE(tactnet::kernels::large_convolution::fits(c));
    CHECK(tactnet::kernels::large_convolution(c).tiles.outputs == tile_outputs);
    large_numbers numbers(c, 1, seed);
    CHECK(numbers.wrong_outputs(0, numbers.run(1).data()) == 0);
}

} // namespace support
