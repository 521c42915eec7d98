#pragma once

#include <tactnet/kernels/simd/vector.hpp>

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
// as in gru_cell.hpp. `in` and `hidden` are the gates' sums over the input and over the hidden state, each
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
