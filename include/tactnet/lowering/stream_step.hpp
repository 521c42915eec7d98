#pragma once

#include <tactnet/lowering/step.hpp>

#include <cstddef>
#include <type_traits>

// What layers do with one frame of a stream. A step has
//   format                         the number format
//   features, outputs              numbers of a frame that it reads and writes
//   element                        of its maps: a float, or a byte. Maps are aligned, in whole vectors
//   output_number                  what it writes: floats, or in 8 bits also bytes
//   map_elements                   of the map that it writes
//   state                          what it remembers from frame to frame; empty for most
//   parameters                     of its layer
//   folded_elements, fold(values, folded)    the numbers that remain, from the parameters of the layer
//   packed_elements, pack(folded, packed)    the same numbers in the order of use; constexpr
//   workspace_elements             memory while it runs
//   run(packed, in, state, out, memory)      from the map of one frame to the next step's; in single
//                                  precision the bits are those of the layer in a batch
//   output_bound(values, input)    in single precision: the largest magnitude of outputs and sums, for inputs
//                                  of such a magnitude
//
// The headers in this folder need neither exceptions nor run-time type information nor files.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A recurrent layer of a cell (layers/time/cells), which remembers its states.
template <class Format, class Cell, std::size_t Features, std::size_t Hidden>
struct recurrent_stream_step;
/// A causal convolution, with a ReLU or without, which remembers the frames that it looks back to. One tap is
/// a dense layer.
template <class Format, std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation,
          bool Rectified = false>
struct causal_stream_step;
/// An activation function.
template <class Format, class Function, std::size_t Features>
struct activation_stream_step;
/// What changes nothing.
template <class Format, std::size_t Features>
struct copying_stream_step;
/// The sum of two branches.
template <class Format, class Main, class Skip>
struct residual_stream_step;

template <class Format, class Cell, std::size_t Features, std::size_t Hidden>
struct step_description<recurrent_stream_step<Format, Cell, Features, Hidden>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::recurrent_stream_step", Cell::title, std::type_identity<Format>{},
           std::type_identity<Cell>{}, Features, Hidden);
    }
};
template <class Format, std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation,
          bool Rectified>
struct step_description<causal_stream_step<Format, Features, Filters, Taps, Dilation, Rectified>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::causal_stream_step", Taps == 1 ? "Dense" : "Causal convolution",
           std::type_identity<Format>{}, Features, Filters, Taps, Dilation, Rectified);
    }
};
template <class Format, class Function, std::size_t Features>
struct step_description<activation_stream_step<Format, Function, Features>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::activation_stream_step", Function::title, std::type_identity<Format>{},
           std::type_identity<Function>{}, Features);
    }
};
template <class Format, std::size_t Features>
struct step_description<copying_stream_step<Format, Features>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::copying_stream_step", "Copy", std::type_identity<Format>{}, Features);
    }
};
template <class Format, class Main, class Skip>
struct step_description<residual_stream_step<Format, Main, Skip>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::residual_stream_step", "Sum of two branches", std::type_identity<Format>{},
           inner_step<Main, step_composition::wrapper>{"main"},
           inner_step<Skip, step_composition::wrapper>{"skip"});
    }
};

}} // namespace tactnet
