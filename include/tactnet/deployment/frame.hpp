#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/tensor/alignment.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

// How a frame comes into a deployed network, and how its outputs leave it, in each number format.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// From counts [channel][row][column] to the map of the first step, pixel by pixel without gaps:
/// (count − mean) × scale. Folded numbers, in every format: the mean frame, the scale, the largest magnitude
/// that the first step may see.
template <class Format, shape Input>
struct input_stage;

template <shape Input>
struct input_stage<single_precision, Input> {
    static constexpr std::size_t folded = Input.size() + 2;
    static constexpr std::size_t packed = whole_lines(Input.size()) + whole_lines(2);
    static constexpr std::size_t map = whole_lines(Input.size()); ///< elements of the first step's input

    static constexpr void pack(const float* from, float* to) {
        std::copy_n(from, Input.size(), to);
        std::copy_n(from + Input.size(), 2, to + whole_lines(Input.size()));
    }
    /// Whether all of the frame is finite and small enough.
    template <class Count>
    static bool read(const float* packed_values, const Count* counts, float* in) noexcept {
        const float* const mean = packed_values;
        const float scale = packed_values[map], limit = packed_values[map + 1];
        // Pools and ReLUs would let a NaN or an infinity vanish: it must be seen here. The limit is one that
        // counts of 8 bits keep.
        if constexpr (Input.channels == 1) {
            return kernels::normalise_counts<Input.size()>(counts, mean, scale, limit, in);
        } else {
            std::uint32_t beyond = 0;
            for (std::size_t channel = 0; channel < Input.channels; ++channel)
                for (std::size_t pixel = 0; pixel < Input.area(); ++pixel) {
                    const std::size_t at = channel * Input.area() + pixel;
                    const float number = (static_cast<float>(counts[at]) - mean[at]) * scale;
                    in[pixel * Input.channels + channel] = number;
                    if constexpr (std::is_floating_point_v<Count>)
                        beyond += !(number <= limit && number >= -limit);
                }
            return beyond == 0;
        }
    }
};

/// From the map of the last step, `Stride` elements from one pixel to the next, to outputs
/// [channel][row][column].
template <class Format, shape Output, std::size_t Stride>
struct output_stage;

template <shape Output, std::size_t Stride>
struct output_stage<single_precision, Output, Stride> {
    static constexpr std::size_t map = whole_lines(Output.area() * Stride); ///< elements of the last map
    /// Whether all outputs are finite.
    static bool write(const float* out, std::span<float, Output.size()> to) noexcept {
        std::uint32_t beyond = 0;
        for (std::size_t channel = 0; channel < Output.channels; ++channel)
            for (std::size_t pixel = 0; pixel < Output.area(); ++pixel)
                to[channel * Output.area() + pixel] = out[pixel * Stride + channel];
        for (const float value : to)
            beyond += !(std::abs(value) <= std::numeric_limits<float>::max());
        return beyond == 0;
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
