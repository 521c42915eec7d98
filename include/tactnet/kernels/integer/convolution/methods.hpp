#pragma once

#include <tactnet/kernels/integer/convolution/dense.hpp>
#include <tactnet/kernels/integer/convolution/depthwise.hpp>
#include <tactnet/kernels/integer/convolution/direct.hpp>
#include <tactnet/kernels/integer/convolution/scalar_depthwise.hpp>
#include <tactnet/kernels/integer/convolution/winograd.hpp>
#include <tactnet/kernels/method_list.hpp>

// The methods for a convolution of one frame in integers (method_list.hpp). All give the same exact sums. The
// unit of their costs is an instruction on a vector, and an element is a byte. In addition to the members
// of every method they have
//   offset               what is subtracted from an input of 8 bits before it is multiplied
//   filter_places        elements of the arrays of the epilogue
//   place(filter)        where the elements of a filter lie in them
//   pack(weight, to)     into zeros; weight(filter, channel of its group, row, column) is a signed byte
//   run(packed, epilogue, input, output, workspace)

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The method that computes a convolution of inputs of type `Input`: bytes, or words of 16 bits.
template <frame_convolution C, class Input>
using integer_method =
    typename method_list<direct_integer_method<C, Input>, winograd_integer_method<C, Input>,
                         depthwise_integer_method<C, Input>, scalar_depthwise_method<C, Input>,
                         dense_integer_method<C, Input>>::cheapest;

}}} // namespace tactnet::kernels
