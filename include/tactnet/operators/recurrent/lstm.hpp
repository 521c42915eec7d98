#pragma once

#include <tactnet/operators/recurrent/layer.hpp>
#include <tactnet/operators/recurrent/lstm_cell.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A layer of long short-term memory, with the parameters of PyTorch's nn.LSTM of one layer.
template <std::size_t Hidden>
using lstm = recurrent<lstm_cell, Hidden>;

}} // namespace tactnet
