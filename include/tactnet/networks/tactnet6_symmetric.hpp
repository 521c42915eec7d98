#pragma once

#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/networks/symmetric_window.hpp>

#include <cstddef>
#include <optional>

namespace tactnet { inline namespace TACTNET_ARCH {

/// TactNet-6 with pools that lie symmetrically on every map. As in tactnet6_economical, each pool halves the
/// map at every size.
template <shape Input, std::size_t Classes>
using tactnet6_symmetric = network<
    Input,                                                                                            //
    conv2d<8, 5>, batch_norm, relu, max_pool<symmetric_window(Input.rows, Input.columns, 2, 0), 2>,   //
    conv2d<16, 3>, batch_norm, relu, max_pool<symmetric_window(Input.rows, Input.columns, 2, 1), 2>,  //
    conv2d<32, 3>, batch_norm, relu, max_pool<symmetric_window(Input.rows, Input.columns, 2, 2), 2>,  //
    conv2d<64, 3>, batch_norm, relu, max_pool<symmetric_window(Input.rows, Input.columns, 2, 3), 2>,  //
    conv2d<128, 3>, batch_norm, relu, max_pool<symmetric_window(Input.rows, Input.columns, 2, 4), 2>, //
    dense<detail::classes_on<Input.rows, Input.columns, Classes>::count>>;

/// The settings of the published training: none, since the network was not published.
[[nodiscard]] constexpr std::optional<published_training> tactnet6_symmetric_training(shape) {
    return {};
}

}} // namespace tactnet
