#pragma once

#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/networks/symmetric_window.hpp>

#include <cstddef>
#include <optional>

// Networks of TactNet-4's layers with symmetric windows.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Filters of the three convolutions.
struct tactnet4_filters {
    std::size_t conv1 = 8, conv2 = 16, conv3 = 32;
};

/// TactNet-4 with symmetric windows, where a stride of the first convolution takes the place of the first
/// pool. The later convolutions have 3 × 3 kernels at every size.
template <shape Input, std::size_t Classes, tactnet4_filters Filters = tactnet4_filters{}>
using tactnet4_strided =
    network<Input,                                                                       //
            conv2d<Filters.conv1, symmetric_window(Input.rows, Input.columns, 4, 0), 2>, //
            batch_norm, relu,                                                            //
            conv2d<Filters.conv2, 3>, batch_norm, relu,                                  //
            max_pool<symmetric_window(Input.rows, Input.columns, 2, 1), 2>,              //
            conv2d<Filters.conv3, 3>, batch_norm, relu,                                  //
            max_pool<symmetric_window(Input.rows, Input.columns, 2, 2), 2>,              //
            dense<detail::classes_on<Input.rows, Input.columns, Classes>::count>>;

/// As tactnet4_strided, with more filters.
template <shape Input, std::size_t Classes>
using tactnet4_wide = tactnet4_strided<Input, Classes, tactnet4_filters{16, 24, 48}>;

/// As tactnet4_wide, with a pool after the first convolution too, which halves the maps of the others.
template <shape Input, std::size_t Classes, tactnet4_filters Filters = tactnet4_filters{16, 24, 48}>
using tactnet4_small = network<Input,                                                                       //
                               conv2d<Filters.conv1, symmetric_window(Input.rows, Input.columns, 4, 0), 2>, //
                               batch_norm, relu,                                                            //
                               max_pool<symmetric_window(Input.rows, Input.columns, 2, 1), 2>,              //
                               conv2d<Filters.conv2, 3>, batch_norm, relu,                                  //
                               max_pool<symmetric_window(Input.rows, Input.columns, 2, 2), 2>,              //
                               conv2d<Filters.conv3, 3>, batch_norm, relu,                                  //
                               max_pool<symmetric_window(Input.rows, Input.columns, 2, 3), 2>,              //
                               dense<detail::classes_on<Input.rows, Input.columns, Classes>::count>>;

/// The settings of the published training: none, since the network was not published.
[[nodiscard]] constexpr std::optional<published_training> tactnet4_strided_training(shape) {
    return {};
}
/// As tactnet4_strided_training.
[[nodiscard]] constexpr std::optional<published_training> tactnet4_wide_training(shape) {
    return {};
}
/// As tactnet4_strided_training.
[[nodiscard]] constexpr std::optional<published_training> tactnet4_small_training(shape) {
    return {};
}

}} // namespace tactnet
