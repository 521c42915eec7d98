#pragma once

#include <tactnet/operators/recurrent/gru_cell.hpp>
#include <tactnet/operators/recurrent/layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A layer of gated recurrent units, with the parameters of PyTorch's nn.GRU of one layer.
template <std::size_t Hidden>
using gru = recurrent<gru_cell, Hidden>;

}} // namespace tactnet
