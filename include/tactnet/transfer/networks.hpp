#pragma once

#include <tactnet/networks/imagenet/alexnet.hpp>
#include <tactnet/networks/imagenet/resnet.hpp>
#include <tactnet/networks/imagenet/squeezenet.hpp>
#include <tactnet/networks/imagenet/vgg16.hpp>
#include <tactnet/networks/published_training.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <cstddef>

// The paper's networks that have learnt from photographs and are trained on with touches (TL-NN): the same
// networks, for an image of one channel, with a last layer of their own. What is published of their training
// is in the authors' programs.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

template <shape Touch, class Network>
struct behind_photograph;
template <shape Touch, class T, shape Photograph, class... Specs>
struct behind_photograph<Touch, basic_network<T, Photograph, Specs...>> {
    using type =
        basic_network<T, Touch, as_photograph<extent2d{Photograph.rows, Photograph.columns}>, Specs...>;
};

} // namespace detail

/// A network of photographs as one of pressure images: with as_photograph in front.
template <shape Touch, class Network>
using behind_photograph = typename detail::behind_photograph<Touch, Network>::type;

template <shape Touch, std::size_t Classes>
using squeezenet_nn = behind_photograph<Touch, squeezenet1_1<shape{227, 227, 3}, Classes>>;
template <shape Touch, std::size_t Classes>
using alexnet_nn = behind_photograph<Touch, alexnet<shape{224, 224, 3}, Classes>>;
template <shape Touch, std::size_t Classes>
using resnet50_nn = behind_photograph<Touch, resnet50<shape{224, 224, 3}, Classes>>;
template <shape Touch, std::size_t Classes>
using vgg16_nn = behind_photograph<Touch, vgg16<shape{224, 224, 3}, Classes>>;

/// How the authors trained each, for images of any size. A rate beside a factor is that of the last layer.
[[nodiscard]] constexpr published_training squeezenet_nn_training(shape) {
    return {.rate = 1e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 15, .batch = 64, .new_layer_factor = 1}};
}
[[nodiscard]] constexpr published_training alexnet_nn_training(shape) {
    return {.rate = 2e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 10, .batch = 5, .new_layer_factor = 20}};
}
[[nodiscard]] constexpr published_training resnet50_nn_training(shape) {
    return {.rate = 1e-3,
            .drop_period = 0,
            .patience = 4,
            .transfer = published_transfer{.epochs = 10, .batch = 16, .new_layer_factor = 1}};
}
[[nodiscard]] constexpr published_training vgg16_nn_training(shape) {
    return {.rate = 2e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 10, .batch = 32, .new_layer_factor = 20}};
}

} // namespace TACTNET_ARCH
} // namespace tactnet
