#pragma once

#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A head for a frozen trunk: layers that are trained on `Features` numbers of each image, which the trunk
/// has found once (feature_extractor, labelled_features). The batch norm in front brings features of any
/// usual scale to one; one whose variance is below its epsilon would fade. `Hidden` is the width of the
/// layer between.
template <std::size_t Features, std::size_t Classes, std::size_t Hidden = 256>
using feature_head = network<shape{1, 1, Features}, batch_norm, dropout<20>, //
                             dense<Hidden>, batch_norm, relu, dropout<50>,   //
                             dense<Classes>>;

} // namespace TACTNET_ARCH
} // namespace tactnet
