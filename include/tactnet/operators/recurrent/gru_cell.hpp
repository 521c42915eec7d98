#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/operators/activations/smooth.hpp>

#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The cell of a gated recurrent unit (Cho et al., "Learning phrase representations using RNN
/// encoder-decoder", 2014), as in PyTorch and cuDNN: with the reset gate r, the update gate z and the new
/// state n,
///     n = tanh(in + r · hidden),  h = n + z · (h − n)
struct gru_cell {
    static constexpr const char *name = "gru", *title = "GRU", *type = "tactnet::gru_cell",
                                *header = "tactnet/operators/recurrent/gru_cell.hpp";
    static constexpr std::size_t gates = 3;      ///< r, z, n: the order of PyTorch
    static constexpr std::size_t states = 1;     ///< h
    static constexpr std::size_t kept_count = 4; ///< r, z, n, and the sum of n over the hidden state

    /// Computes r, z and the argument of the hyperbolic tangent that gives n, from the gates' sums over the
    /// input and over the hidden state, biases included.
    template <class Number>
    static void open(const std::array<Number, 3>& in, const std::array<Number, 3>& hidden,
                     std::array<Number, 4>& kept) {
        const Number r = sigmoid_function::value(in[0] + hidden[0]);
        const Number z = sigmoid_function::value(in[1] + hidden[1]);
        kept = {r, z, kernels::fused_multiply_add(r, hidden[2], in[2]), hidden[2]};
    }
    /// Updates the state, and completes what the backward pass needs.
    template <class Number>
    static void update(std::array<Number, 4>& kept, std::array<Number, 1>& state) {
        const Number n = hyperbolic_tangent_function::value(kept[2]);
        state[0] = kernels::fused_multiply_add(kept[1], Number(state[0] - n), n);
        kept[2] = n;
    }
    /// From what was kept and the state before: turns the gradient of the state after into its direct
    /// part of the gradient of the state before, and sets the gradients of the gates' sums.
    template <class Number>
    static void backward(const std::array<Number, 4>& kept, const std::array<Number, 1>& before,
                         std::array<Number, 1>& gradient, std::array<Number, 3>& in,
                         std::array<Number, 3>& hidden) {
        const auto& [r, z, n, sum] = kept;
        const Number of_n = hyperbolic_tangent_function::backward(n, gradient[0] * (Number(1) - z));
        const Number of_z = sigmoid_function::backward(z, gradient[0] * (before[0] - n));
        const Number of_r = sigmoid_function::backward(r, of_n * sum);
        in = {of_r, of_z, of_n};
        hidden = {of_r, of_z, of_n * r};
        gradient[0] = gradient[0] * z;
    }
};

}} // namespace tactnet
