#pragma once

#include <tactnet/operators/layer.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Convolution over the frames of a sequence that looks back only, as in temporal convolutional networks
/// (Bai, Kolter, Koltun, 2018): the output for a frame is a sum over this frame and those `Dilation`, …,
/// (Taps − 1) · `Dilation` frames before it. Frames before the first are zero. Parameters are those of
/// PyTorch's nn.Conv1d, weight [filters, features, taps], with the last tap for the present frame, and bias.
/// One tap is a dense layer for each frame.
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation = 1>
struct causal_conv1d {
    static constexpr std::string_view name = "conv";
    static constexpr bool numbered = true, takes_sequences = true;
    static constexpr std::size_t filters = Filters, taps = Taps, dilation = Dilation;
    /// The frames before the present one that the output depends on.
    static constexpr std::size_t frames_before = Taps > 0 ? (Taps - 1) * Dilation : 0;

    static constexpr layer_costs costs(const shape& input) {
        const std::size_t weights = Filters * input.channels * Taps;
        std::size_t real = 0;
        for (std::size_t tap = 0; tap < Taps; ++tap)
            real += input.rows - std::min(input.rows, tap * Dilation);
        return {.output = {input.rows, 1, Filters},
                .parameters = weights + Filters,
                .multiply_adds = input.rows * weights,
                .multiply_adds_on_pixels = Filters * input.channels * real};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, causal_conv1d> {
        static constexpr shape output =
            detail::sequence_output<Input.columns, Filters * Taps * Dilation>({Input.rows, 1, Filters});
        static constexpr std::size_t frames = Input.rows, features = Input.channels;
        static constexpr std::size_t inputs = features * Taps; ///< of one output
        static constexpr std::size_t biases = Filters * inputs;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::weight, {Filters, features, Taps}, 0,
                           inputs);
            describe_array(list, prefix, "bias", parameter_role::bias, {Filters}, biases);
        }
    };
};

}} // namespace tactnet
