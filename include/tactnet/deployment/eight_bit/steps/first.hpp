#pragma once

#include <tactnet/deployment/eight_bit/steps/average_pool.hpp>
#include <tactnet/deployment/eight_bit/steps/elementwise.hpp>
#include <tactnet/deployment/eight_bit/steps/pool.hpp>

#include <cstddef>
#include <cstdint>

// What cannot read the frame: its words of 16 bits become bytes by what multiplies, and these steps do not.
// Said in one sentence, and then taken for steps that read bytes, so that no other error follows.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

template <std::size_t Stride>
struct cannot_read_the_frame {
    static_assert(Stride == 0,
                  "deploy: in 8 bits a network cannot begin with a pool or a ReLU: a convolution, "
                  "a dense layer or a batch norm must come first");
};

} // namespace detail

template <sliding_window Window, std::size_t Stride>
struct pool_step<eight_bit::input_format, Window, Stride> : pool_step<eight_bit, Window, Stride>,
                                                            detail::cannot_read_the_frame<Stride> {};

template <class Function, shape Map, std::size_t Stride>
struct activation_step<eight_bit::input_format, Function, Map, Stride>
    : activation_step<eight_bit, Function, Map, Stride>, detail::cannot_read_the_frame<Stride> {};

template <class Output, average_windows Windows, std::size_t Channels, std::size_t Stride>
struct average_pool_step<eight_bit_between<std::int16_t, Output>, Windows, Channels, Stride>
    : average_pool_step<eight_bit_between<std::uint8_t, Output>, Windows, Channels, Stride>,
      detail::cannot_read_the_frame<Stride> {};

} // namespace TACTNET_ARCH
} // namespace tactnet
