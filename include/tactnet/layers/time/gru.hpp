#pragma once

#include <tactnet/layers/time/cells/gru_cell.hpp>
#include <tactnet/layers/time/recurrent.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A layer of gated recurrent units, with the parameters of PyTorch's nn.GRU of one layer.
template <std::size_t Hidden>
using gru = recurrent<gru_cell, Hidden>;

}} // namespace tactnet
