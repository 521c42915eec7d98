#pragma once

#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Layers that are trained behind a trunk that stays as it is, on `Features` numbers of each image that were
/// found once (feature_extractor, labelled_features). The batch norm in front brings features of any scale to
/// one. `Hidden` is the width of the layer between.
template <std::size_t Features, std::size_t Classes, std::size_t Hidden = 256>
using feature_network = network<shape{1, 1, Features}, batch_norm, dropout<20>, //
                                dense<Hidden>, batch_norm, relu, dropout<50>,   //
                                dense<Classes>>;

} // namespace TACTNET_ARCH
} // namespace tactnet
