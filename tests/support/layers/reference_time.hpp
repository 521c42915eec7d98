#pragma once

// The reference of the layers that run through time. Their gradients are compared with finite differences
// alone.

#include <cstddef>
#include <support/layers/reference.hpp>

namespace support {

/// PyTorch's nn.GRU and nn.LSTM of one layer.
reference_pointer reference_gru(extents3 input, std::size_t hidden);
reference_pointer reference_lstm(extents3 input, std::size_t hidden);
/// PyTorch's nn.Conv1d after a padding with zeros before the first frame.
reference_pointer reference_causal_conv1d(extents3 input, std::size_t filters, std::size_t taps,
                                          std::size_t dilation);
reference_pointer reference_last_frame(extents3 input);

} // namespace support
