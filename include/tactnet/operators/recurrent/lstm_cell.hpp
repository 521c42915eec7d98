#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/operators/activations/smooth.hpp>

#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The cell of a long short-term memory (Hochreiter and Schmidhuber, 1997) with forget gates (Gers,
/// Schmidhuber and Cummins, 2000), as in PyTorch: with the input gate i, the forget gate f, the new content g
/// and the output gate o,
///     c = f · c + i · g,  h = o · tanh(c)
struct lstm_cell {
    static constexpr const char *name = "lstm", *title = "LSTM", *type = "tactnet::lstm_cell",
                                *header = "tactnet/operators/recurrent/lstm_cell.hpp";
    static constexpr std::size_t gates = 4;      ///< i, f, g, o: the order of PyTorch
    static constexpr std::size_t states = 2;     ///< h, c
    static constexpr std::size_t kept_count = 5; ///< i, f, g, o, tanh(c)

    /// The gates, from their sums over the input and over the hidden state, biases included.
    template <class Number>
    static void open(const std::array<Number, 4>& in, const std::array<Number, 4>& hidden,
                     std::array<Number, 5>& kept) {
        kept = {sigmoid_function::value(in[0] + hidden[0]), sigmoid_function::value(in[1] + hidden[1]),
                hyperbolic_tangent_function::value(in[2] + hidden[2]),
                sigmoid_function::value(in[3] + hidden[3]), Number(0)};
    }
    /// Updates the states, and completes what the backward pass needs.
    template <class Number>
    static void update(std::array<Number, 5>& kept, std::array<Number, 2>& state) {
        state[1] = kernels::fused_multiply_add(kept[1], state[1], Number(kept[0] * kept[2]));
        kept[4] = hyperbolic_tangent_function::value(state[1]);
        state[0] = kept[3] * kept[4];
    }
    /// From what was kept and the states before: turns the gradients of the states after into their
    /// direct parts of the gradients of the states before, and sets the gradients of the gates' sums.
    template <class Number>
    static void backward(const std::array<Number, 5>& kept, const std::array<Number, 2>& before,
                         std::array<Number, 2>& gradient, std::array<Number, 4>& in,
                         std::array<Number, 4>& hidden) {
        const auto& [i, f, g, o, content] = kept;
        const Number of_c = gradient[1] + hyperbolic_tangent_function::backward(content, gradient[0] * o);
        in = {sigmoid_function::backward(i, of_c * g), sigmoid_function::backward(f, of_c * before[1]),
              hyperbolic_tangent_function::backward(g, of_c * i),
              sigmoid_function::backward(o, gradient[0] * content)};
        hidden = in;
        gradient = {Number(0), of_c * f};
    }
};

}} // namespace tactnet
