#pragma once

#include <tactnet/operators/convolution/eight_bit.hpp>
#include <tactnet/operators/dense/step.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A dense layer in 8 bits: a convolution with a kernel as large as the map.
template <class Input, class Output, kernels::frame_dense Kernel>
struct dense_step<eight_bit_between<Input, Output>, Kernel>
    : convolution_step<eight_bit_between<Input, Output>,
                       kernels::frame_convolution{
                           .window = {Kernel.input, {Kernel.input.rows, Kernel.input.columns}, 1},
                           .filters = Kernel.outputs,
                           .input_stride = Kernel.input_stride}> {};

}} // namespace tactnet
