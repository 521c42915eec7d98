#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>
#include <optional>

namespace tactnet { inline namespace TACTNET_ARCH {

/// What varies in TactNet-6: the kernel of the second and the fifth convolution and the strides of the pools.
struct tactnet6_form {
    std::size_t kernel2 = 3; ///< the paper's text says 5; the authors' programs and its parameter count say 3
    std::size_t kernel5 = 3;
    std::size_t first_pool_stride = 2;
    std::size_t other_pools_stride = 2;

    /// As in the authors' programs: at 20 × 35 and 14 × 25 the first pool has stride 1, at 10 × 18 and 7 × 13
    /// all pools have, and the fifth kernel is 2 × 2. Fewer halvings keep the maps of small images large
    /// enough, and make them cost more than large ones.
    [[nodiscard]] static constexpr tactnet6_form at(shape image) {
        switch (published_resolution_of(image)) {
        case published_resolution::r7x13:
        case published_resolution::r10x18:
            return {.kernel5 = 2, .first_pool_stride = 1, .other_pools_stride = 1};
        case published_resolution::r14x25:
        case published_resolution::r20x35:
            return {.kernel5 = 2, .first_pool_stride = 1};
        case published_resolution::r28x50:
            break;
        }
        return {};
    }
    /// All pools halve at every resolution, so that the cost falls with the number of tactels.
    [[nodiscard]] static constexpr tactnet6_form economical() { return {}; }
};

/// TactNet-6 (Gandarias et al., 2019, table I): five convolutions and a dense layer.
template <shape Input, std::size_t Classes, tactnet6_form Form = tactnet6_form::at(Input)>
using tactnet6 = network<Input,                                                                             //
                         conv2d<8, 5>, batch_norm, relu, max_pool<2, Form.first_pool_stride>,               //
                         conv2d<16, Form.kernel2>, batch_norm, relu, max_pool<2, Form.other_pools_stride>,  //
                         conv2d<32, 3>, batch_norm, relu, max_pool<2, Form.other_pools_stride>,             //
                         conv2d<64, 3>, batch_norm, relu, max_pool<2, Form.other_pools_stride>,             //
                         conv2d<128, Form.kernel5>, batch_norm, relu, max_pool<2, Form.other_pools_stride>, //
                         dense<detail::classes_on<Input.rows, Input.columns, Classes>::count>>;

/// TactNet-6 whose cost falls with the resolution. Beyond 20 × 35 it is the same type as TactNet-6.
template <shape Input, std::size_t Classes>
using tactnet6_economical = tactnet6<Input, Classes, tactnet6_form::economical()>;

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

/// The authors' training at each of their five resolutions; sizes in between take the settings of their form.
[[nodiscard]] constexpr published_training tactnet6_training(shape image) {
    switch (published_resolution_of(image)) {
    case published_resolution::r7x13:
    case published_resolution::r10x18:
        return {.rate = 0.008, .drop_period = 150, .patience = 7, .drop_factor = 0.7, .validate_every = 15};
    case published_resolution::r14x25:
        return {.rate = 0.1, .drop_period = 100, .patience = 7, .drop_factor = 0.7, .validate_every = 15};
    case published_resolution::r20x35:
        return {.rate = 0.1, .drop_period = 100, .patience = 5, .drop_factor = 0.7, .validate_every = 15};
    case published_resolution::r28x50:
        break;
    }
    return {.rate = 0.01, .drop_period = 150, .patience = 4};
}
/// The training of TactNet-6 for the economical form, which was not published.
[[nodiscard]] constexpr published_training tactnet6_economical_training(shape image) {
    return tactnet6_training(image);
}
/// The settings of the published training: none, since the network was not published.
[[nodiscard]] constexpr std::optional<published_training> tactnet6_symmetric_training(shape) {
    return {};
}

}} // namespace tactnet
