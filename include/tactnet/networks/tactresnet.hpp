#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/operators.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The pools of TactResNet, which was published for 28 × 50 only.
struct tactresnet_form {
    std::size_t first_pool = 3, first_pool_stride = 2, last_pool = 5;

    /// Both pools scale with the smaller side of the image. The first convolution leaves r = ceil(side / 2)
    /// rows. The first pool has the window ceil(r / 5), at most 3, and the stride min(2, window). The last
    /// one, at most 5, leaves at least two rows if there are two. At 28 × 50 this gives the published 3, 2
    /// and 5.
    [[nodiscard]] static constexpr tactresnet_form at(shape image) {
        const std::size_t side = (std::min(image.rows, image.columns) + 1) / 2;
        const std::size_t first = std::clamp<std::size_t>((side + 4) / 5, 1, 3);
        const std::size_t stride = std::min<std::size_t>(first, 2);
        const std::size_t pooled = side >= first ? (side - first) / stride + 1 : 1;
        return {first, stride, std::clamp<std::size_t>(pooled - 1, 1, 5)};
    }
};

/// Two 3 × 3 convolutions with batch norm: the main branch of a block.
template <std::size_t Filters>
using two_convolutions = sequence<conv2d<Filters, 3>, batch_norm, relu, conv2d<Filters, 3>, batch_norm>;

/// TactResNet (Gandarias et al., 2019, figure 5): four residual blocks, the third with a projection 64 → 128.
template <shape Input, std::size_t Classes, tactresnet_form Form = tactresnet_form::at(Input)>
using tactresnet = network<Input,                                                                       //
                           conv2d<64, 5, 2, pad(2)>, batch_norm, relu,                                  //
                           max_pool<Form.first_pool, Form.first_pool_stride, padding::valid>,           //
                           residual<two_convolutions<64>>, relu,                                        //
                           residual<two_convolutions<64>>, relu,                                        //
                           residual<two_convolutions<128>, sequence<conv2d<128, 3>, batch_norm>>, relu, //
                           residual<two_convolutions<128>>, relu,                                       //
                           max_pool<Form.last_pool, 1, padding::valid>,                                 //
                           dense<detail::classes_on<Input.rows, Input.columns, Classes>::count>>;

/// The authors' training at 28 × 50, for images of any size. The input are counts.
[[nodiscard]] constexpr published_training tactresnet_training(shape) {
    return {.rate = 0.002, .drop_period = 0, .patience = 5, .subtracts_mean = false};
}

}} // namespace tactnet
