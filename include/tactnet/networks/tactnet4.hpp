#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>
#include <optional>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Kernels of TactNet-4's three convolutions.
struct tactnet4_form {
    std::size_t kernel1 = 5, kernel2 = 3, kernel3 = 3;

    /// As published at 28 × 50 (5, 3, 3) and at 14 × 25 (3, 2, 2; the authors' trained network). Unpublished
    /// sizes take the first.
    [[nodiscard]] static constexpr tactnet4_form at(shape image) {
        if (published_resolution_of(image) == published_resolution::r14x25)
            return {.kernel1 = 3, .kernel2 = 2, .kernel3 = 2};
        return {};
    }
};

/// TactNet-4 (Gandarias et al., 2019, table I, at 28 × 50): three convolutions and a dense layer. Every map
/// is halved three times.
template <shape Input, std::size_t Classes, tactnet4_form Form = tactnet4_form::at(Input)>
using tactnet4 = network<Input,                                                   //
                         conv2d<8, Form.kernel1>, batch_norm, relu, max_pool<2>,  //
                         conv2d<16, Form.kernel2>, batch_norm, relu, max_pool<2>, //
                         conv2d<32, Form.kernel3>, batch_norm, relu, max_pool<2>, //
                         dense<detail::classes_on<Input.rows, Input.columns, Classes>::count>>;

/// TactNet-4 with kernels of 3 × 3, for images of few tactels: on 8 × 16 it is faster and more accurate than
/// the published kernels on 7 × 13. Where both sides are multiples of 8, no pool reaches beyond its map.
template <shape Input, std::size_t Classes>
using tactnet4_3x3 = tactnet4<Input, Classes, tactnet4_form{.kernel1 = 3, .kernel2 = 3, .kernel3 = 3}>;

/// TactNet-4 with symmetric windows, where a stride of the first convolution takes the place of the first
/// pool. The later convolutions have 3 × 3 kernels at every size.
template <shape Input, std::size_t Classes>
using tactnet4_strided = network<Input,                                                           //
                                 conv2d<8, symmetric_window(Input.rows, Input.columns, 4, 0), 2>, //
                                 batch_norm, relu,                                                //
                                 conv2d<16, 3>, batch_norm, relu,                                 //
                                 max_pool<symmetric_window(Input.rows, Input.columns, 2, 1), 2>,  //
                                 conv2d<32, 3>, batch_norm, relu,                                 //
                                 max_pool<symmetric_window(Input.rows, Input.columns, 2, 2), 2>,  //
                                 dense<detail::classes_on<Input.rows, Input.columns, Classes>::count>>;

/// The authors' training at 28 × 50, for images of any size: nothing else is known about 14 × 25.
[[nodiscard]] constexpr published_training tactnet4_training(shape) {
    return {.rate = 0.05, .drop_period = 200, .patience = 3};
}
/// The settings of the published training: none, since the network was not published.
[[nodiscard]] constexpr std::optional<published_training> tactnet4_3x3_training(shape) {
    return {};
}
/// As tactnet4_3x3_training.
[[nodiscard]] constexpr std::optional<published_training> tactnet4_strided_training(shape) {
    return {};
}

}} // namespace tactnet
