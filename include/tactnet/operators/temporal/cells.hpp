#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/operators/activations/smooth.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>

// The cell of a recurrent layer, in a batch as in a stream. It is a struct with
//   name, gates, states, kept_count   constants: the numbers of each hidden unit
//   title, type, header               for exported headers: its name for people and in C++, and the file that
//                                     declares it
//   open(in, hidden, kept), update(kept, state)
//   backward(kept, before, gradient, in, hidden)
// as in gru_cell below. `in` and `hidden` are the gates' sums over the input and over the hidden state, each
// with its bias; the first state is the hidden state, which is the output. Each function takes arrays of
// kernels::vector<float> or of double.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// What the functions of a cell take, in a computation with T.
template <class T>
using cell_number = std::conditional_t<std::same_as<T, float>, kernels::vector<float>, T>;
/// The elements of a cell_number.
template <class T>
inline constexpr std::size_t cell_lanes = std::same_as<T, float> ? kernels::lanes<float> : 1;

/// The numbers at from[0], from[stride], …, as a cell takes them.
template <std::size_t Count, class T>
[[nodiscard]] std::array<cell_number<T>, Count> load_cell(const T* from, std::size_t stride) {
    std::array<cell_number<T>, Count> values;
    for (std::size_t i = 0; i < Count; ++i)
        if constexpr (std::same_as<T, float>)
            values[i] = kernels::load(from + i * stride);
        else
            values[i] = from[i * stride];
    return values;
}
template <std::size_t Count, class T>
void store_cell(const std::array<cell_number<T>, Count>& values, T* to, std::size_t stride) {
    for (std::size_t i = 0; i < Count; ++i)
        if constexpr (std::same_as<T, float>)
            kernels::store(to + i * stride, values[i]);
        else
            to[i * stride] = values[i];
}

/// One step of `count` hidden units. Elements of one unit lie `count` apart, unit by unit in multiples of
/// cell_lanes<T>: in the gates' sums, in the state, which is updated, and in `kept` for the backward pass.
/// All gates come first, since functions of independent numbers overlap in the processor.
template <class Cell, class T>
void update_cells(std::size_t count, const T* in, const T* hidden, T* state, T* kept) {
    std::array<cell_number<T>, Cell::kept_count> k;
    for (std::size_t i = 0; i < count; i += cell_lanes<T>) {
        Cell::open(load_cell<Cell::gates>(in + i, count), load_cell<Cell::gates>(hidden + i, count), k);
        store_cell(k, kept + i, count);
    }
    for (std::size_t i = 0; i < count; i += cell_lanes<T>) {
        k = load_cell<Cell::kept_count>(kept + i, count);
        auto s = load_cell<Cell::states>(state + i, count);
        Cell::update(k, s);
        store_cell(k, kept + i, count);
        store_cell(s, state + i, count);
    }
}

} // namespace detail

}} // namespace tactnet

namespace tactnet { inline namespace TACTNET_ARCH {

/// The cell of a gated recurrent unit (Cho et al., "Learning phrase representations using RNN
/// encoder-decoder", 2014), as in PyTorch and cuDNN: with the reset gate r, the update gate z and the new
/// state n,
///     n = tanh(in + r · hidden),  h = n + z · (h − n)
struct gru_cell {
    static constexpr const char *name = "gru", *title = "GRU", *type = "tactnet::gru_cell",
                                *header = "tactnet/operators/temporal/cells.hpp";
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

/// The cell of a long short-term memory (Hochreiter and Schmidhuber, 1997) with forget gates (Gers,
/// Schmidhuber and Cummins, 2000), as in PyTorch: with the input gate i, the forget gate f, the new content g
/// and the output gate o,
///     c = f · c + i · g,  h = o · tanh(c)
struct lstm_cell {
    static constexpr const char *name = "lstm", *title = "LSTM", *type = "tactnet::lstm_cell",
                                *header = "tactnet/operators/temporal/cells.hpp";
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
