#pragma once

#include <tactnet/deployment/eight_bit/streaming/steps.hpp>
#include <tactnet/deployment/lowering/streams.hpp>

#include <cstddef>
#include <cstdint>
#include <type_traits>

// How layers become steps of a stream in 8 bits.

namespace tactnet { inline namespace TACTNET_ARCH {

template <class Cell, std::size_t Hidden, shape Input, class In, class Out>
    requires requires { sizeof(detail::word_cell<Cell>); }
struct stream_lowering<recurrent<Cell, Hidden>, Input, eight_bit_between<In, Out>> {
    using step = recurrent_stream_step<eight_bit_between<In, Out>, Cell, Input.channels, Hidden>;
};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, shape Input, class In, class Out>
struct stream_lowering<causal_conv1d<Filters, Taps, Dilation>, Input, eight_bit_between<In, Out>> {
    using step = causal_stream_step<eight_bit_between<In, Out>, Input.channels, Filters, Taps, Dilation>;
};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, shape Input, class In, class Out>
struct stream_lowering<detail::rectified<causal_conv1d<Filters, Taps, Dilation>>, Input,
                       eight_bit_between<In, Out>> {
    using step =
        causal_stream_step<eight_bit_between<In, Out>, Input.channels, Filters, Taps, Dilation, true>;
};
/// A dense layer after `last_frame`.
template <std::size_t Outputs, shape Input, class In, class Out>
    requires(Input.area() == 1)
struct stream_lowering<dense<Outputs>, Input, eight_bit_between<In, Out>> {
    using step = causal_stream_step<eight_bit_between<In, Out>, Input.channels, Outputs, 1, 1>;
};
template <std::size_t Outputs, shape Input, class In, class Out>
    requires(Input.area() == 1)
struct stream_lowering<detail::rectified<dense<Outputs>>, Input, eight_bit_between<In, Out>> {
    using step = causal_stream_step<eight_bit_between<In, Out>, Input.channels, Outputs, 1, 1, true>;
};
template <class Function, shape Input, class Out>
struct stream_lowering<activation<Function>, Input, eight_bit_between<std::uint8_t, Out>> {
    using step = activation_stream_step<eight_bit_between<std::uint8_t, Out>, Function, Input.channels>;
};
template <class Main, class Skip, shape Input, class Out>
struct stream_lowering<residual<Main, Skip>, Input, eight_bit_between<std::uint8_t, Out>> {
    using step = residual_stream_step<eight_bit_between<std::uint8_t, Out>,
                                      typename stream_lowering<as_sequence<Main>, Input, eight_bit>::step,
                                      typename stream_lowering<as_sequence<Skip>, Input, eight_bit>::step>;
};

namespace detail {

template <class In, class Out, bool Last>
struct format_of_stream_step<eight_bit_between<In, Out>, Last> {
    using type = eight_bit_between<In, std::conditional_t<Last, Out, std::uint8_t>>;
};
template <class In, class Out, class Number>
struct format_after_stream_step<eight_bit_between<In, Out>, Number> {
    using type = eight_bit_between<Number, Out>;
};

} // namespace detail
}} // namespace tactnet
