#pragma once

// A network of your own whose steps none of the library's networks have.

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>
#include <ratio>

namespace rooted {

using namespace tactnet;

/// Roots of counts first, and probabilities as outputs.
template <shape Input, std::size_t Classes>
using roots = network<Input, square_root<std::ratio<3, 8>>, conv2d<8, 3>, batch_norm, relu, max_pool<2>,
                      dense<Classes>, softmax>;

} // namespace rooted
