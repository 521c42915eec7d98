#pragma once

#include <tactnet/networks/imagenet/alexnet.hpp>
#include <tactnet/networks/imagenet/resnet.hpp>
#include <tactnet/networks/imagenet/squeezenet.hpp>
#include <tactnet/networks/imagenet/vgg16.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <cstddef>

// The paper's ImageNet networks for transfer learning (TL-NN): pretrained on photographs, fine-tuned on
// pressure images of one channel, with a new last layer. The training settings are those of the authors'
// programs.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <shape Touch, class Network>
struct with_photograph_input;
template <shape Touch, class T, shape Photograph, class... Specs>
struct with_photograph_input<Touch, basic_network<T, Photograph, Specs...>> {
    using type =
        basic_network<T, Touch, as_photograph<extent2d{Photograph.rows, Photograph.columns}>, Specs...>;
};

} // namespace detail

/// Puts as_photograph before a network for photographs, so that it takes pressure images.
template <shape Touch, class Network>
using with_photograph_input = typename detail::with_photograph_input<Touch, Network>::type;

/// SqueezeNet 1.1 for touches.
template <shape Touch, std::size_t Classes>
using squeezenet_nn = with_photograph_input<Touch, squeezenet1_1<shape{227, 227, 3}, Classes>>;
/// AlexNet for touches.
template <shape Touch, std::size_t Classes>
using alexnet_nn = with_photograph_input<Touch, alexnet<shape{224, 224, 3}, Classes>>;
/// ResNet-50 for touches.
template <shape Touch, std::size_t Classes>
using resnet50_nn = with_photograph_input<Touch, resnet50<shape{224, 224, 3}, Classes>>;
/// VGG16 for touches.
template <shape Touch, std::size_t Classes>
using vgg16_nn = with_photograph_input<Touch, vgg16<shape{224, 224, 3}, Classes>>;

/// How the authors trained SqueezeNet, for images of any size. The rate is that of the last layer; the other
/// layers learn at the rate divided by `new_layer_factor`.
[[nodiscard]] constexpr published_training squeezenet_nn_training(shape) {
    return {.rate = 1e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 15, .batch = 64, .new_layer_factor = 1}};
}
/// How the authors trained AlexNet.
[[nodiscard]] constexpr published_training alexnet_nn_training(shape) {
    return {.rate = 2e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 10, .batch = 5, .new_layer_factor = 20}};
}
/// How the authors trained ResNet-50.
[[nodiscard]] constexpr published_training resnet50_nn_training(shape) {
    return {.rate = 1e-3,
            .drop_period = 0,
            .patience = 4,
            .transfer = published_transfer{.epochs = 10, .batch = 16, .new_layer_factor = 1}};
}
/// How the authors trained VGG16.
[[nodiscard]] constexpr published_training vgg16_nn_training(shape) {
    return {.rate = 2e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 10, .batch = 32, .new_layer_factor = 20}};
}

}} // namespace tactnet
