#pragma once

#include <tactnet/layers/time/cells/lstm_cell.hpp>
#include <tactnet/layers/time/recurrent.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A layer of long short-term memory, with the parameters of PyTorch's nn.LSTM of one layer.
template <std::size_t Hidden>
using lstm = recurrent<lstm_cell, Hidden>;

}} // namespace tactnet
