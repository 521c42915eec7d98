#pragma once

#include <tactnet/operators/layer.hpp>
#include <tactnet/operators/temporal/cells.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// The layer of a recurrent cell (cells/cell.hpp). Every sum adds its terms in the order of the inputs, in
// batches as in streams, so that both have the same bits.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A recurrent layer of `Hidden` units: a sequence of features in, the hidden state after each frame out. The
/// state before the first frame is zero. Parameters have the names and the layouts of one layer of PyTorch's
/// modules: weight_ih_l0 [gates · Hidden, features], weight_hh_l0 [gates · Hidden, Hidden], and the biases
/// bias_ih_l0 and bias_hh_l0.
template <class Cell, std::size_t Hidden>
struct recurrent {
    static constexpr std::string_view name = Cell::name;
    static constexpr bool numbered = false, takes_sequences = true;
    static constexpr std::size_t hidden = Hidden, rows = Cell::gates * Hidden; ///< of both matrices
    using cell = Cell;

    static constexpr layer_costs costs(const shape& input) {
        const std::size_t weights = rows * (input.channels + Hidden), products = input.rows * weights;
        return {.output = {input.rows, 1, Hidden},
                .parameters = weights + 2 * rows,
                .multiply_adds = products,
                .multiply_adds_on_pixels = products};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, recurrent> {
        static constexpr shape output =
            detail::sequence_output<Input.columns, Hidden>({Input.rows, 1, Hidden});
        static constexpr std::size_t frames = Input.rows, features = Input.channels;
        /// Where the arrays begin among the parameters.
        static constexpr std::size_t hidden_weights = rows * features,
                                     input_biases = hidden_weights + rows * Hidden,
                                     hidden_biases = input_biases + rows;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight_ih_l0", parameter_role::weight, {rows, features}, 0,
                           features);
            describe_array(list, prefix, "weight_hh_l0", parameter_role::weight, {rows, Hidden},
                           hidden_weights, Hidden);
            describe_array(list, prefix, "bias_ih_l0", parameter_role::bias, {rows}, input_biases);
            describe_array(list, prefix, "bias_hh_l0", parameter_role::bias, {rows}, hidden_biases);
        }
    };
};

/// A layer of gated recurrent units, with the parameters of PyTorch's nn.GRU of one layer.
template <std::size_t Hidden>
using gru = recurrent<gru_cell, Hidden>;

/// A layer of long short-term memory, with the parameters of PyTorch's nn.LSTM of one layer.
template <std::size_t Hidden>
using lstm = recurrent<lstm_cell, Hidden>;

/// The features of the last frame of a sequence, without the others: what a classifier of whole sequences
/// reads after a recurrent or a causal layer. In a stream the last frame is the present one.
struct last_frame {
    static constexpr std::string_view name = "last";
    static constexpr bool numbered = true, takes_sequences = true;

    static constexpr layer_costs costs(const shape& input) { return {.output = {1, 1, input.channels}}; }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, last_frame> {
        static constexpr shape output = detail::sequence_output<Input.columns, 1>({1, 1, Input.channels});
    };
};

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
