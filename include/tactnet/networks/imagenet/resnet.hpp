#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>
#include <type_traits>
#include <utility>

// Residual networks (He, Zhang, Ren, Sun, "Deep residual learning for image recognition", 2016, table 1), for
// images of three channels, by convention 224 × 224. As in torchvision, the 3 × 3 convolution of a bottleneck
// has its stride (version 1.5), and arrays have torchvision's names.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A convolution with padding that keeps the size of the map at stride 1. The batch norm after it has the
/// bias.
template <std::size_t Filters, std::size_t Kernel, std::size_t Stride>
using resnet_convolution = conv2d<Filters, Kernel, Stride, pad(Kernel / 2), without_bias>;

/// The projection of a block whose input and output differ in size.
template <std::size_t Filters, std::size_t Stride>
using resnet_downsample = named<"downsample", sequential<resnet_convolution<Filters, 1, Stride>, batch_norm>>;

/// Two 3 × 3 convolutions. The first block of a stage may have a stride, and a projection as its skip.
template <std::size_t Filters, std::size_t Stride, bool Projects>
using basic_block = sequence<
    named<"",
          residual<unnamed<named<"conv1", resnet_convolution<Filters, 3, Stride>>, named<"bn1", batch_norm>,
                           relu, named<"conv2", resnet_convolution<Filters, 3, 1>>, named<"bn2", batch_norm>>,
                   std::conditional_t<Projects, resnet_downsample<Filters, Stride>, identity_layer>>>,
    relu>;

/// 1 × 1, 3 × 3 and 1 × 1: the outer ones narrow the map and widen it by four.
template <std::size_t Filters, std::size_t Stride, bool Projects>
using bottleneck = sequence<
    named<"",
          residual<
              unnamed<named<"conv1", resnet_convolution<Filters, 1, 1>>, named<"bn1", batch_norm>, relu,
                      named<"conv2", resnet_convolution<Filters, 3, Stride>>, named<"bn2", batch_norm>, relu,
                      named<"conv3", resnet_convolution<4 * Filters, 1, 1>>, named<"bn3", batch_norm>>,
              std::conditional_t<Projects, resnet_downsample<4 * Filters, Stride>, identity_layer>>>,
    relu>;

namespace detail {

/// A first block, then equal ones.
template <class First, class Other, class Indices>
struct resnet_stage;
template <class First, class Other, std::size_t... I>
struct resnet_stage<First, Other, std::index_sequence<I...>> {
    using type = sequential<First, std::enable_if_t<(I < sizeof...(I)), Other>...>;
};

} // namespace detail

/// The blocks of a stage.
template <class First, class Other, std::size_t Blocks>
    requires(Blocks > 0)
using resnet_stage = typename detail::resnet_stage<First, Other, std::make_index_sequence<Blocks - 1>>::type;

/// The layers before the first stage.
using resnet_stem = unnamed<named<"conv1", resnet_convolution<64, 7, 2>>, named<"bn1", batch_norm>, relu,
                            max_pool<3, 2, pad(1)>>;

/// Four stages of basic blocks; the first needs no projection.
template <std::size_t A, std::size_t B, std::size_t C, std::size_t D>
using resnet_basic_features =
    unnamed<resnet_stem,                                                                             //
            named<"layer1", resnet_stage<basic_block<64, 1, false>, basic_block<64, 1, false>, A>>,  //
            named<"layer2", resnet_stage<basic_block<128, 2, true>, basic_block<128, 1, false>, B>>, //
            named<"layer3", resnet_stage<basic_block<256, 2, true>, basic_block<256, 1, false>, C>>, //
            named<"layer4", resnet_stage<basic_block<512, 2, true>, basic_block<512, 1, false>, D>>>;
/// Four stages of bottlenecks.
template <std::size_t A, std::size_t B, std::size_t C, std::size_t D>
using resnet_bottleneck_features =
    unnamed<resnet_stem,                                                                           //
            named<"layer1", resnet_stage<bottleneck<64, 1, true>, bottleneck<64, 1, false>, A>>,   //
            named<"layer2", resnet_stage<bottleneck<128, 2, true>, bottleneck<128, 1, false>, B>>, //
            named<"layer3", resnet_stage<bottleneck<256, 2, true>, bottleneck<256, 1, false>, C>>, //
            named<"layer4", resnet_stage<bottleneck<512, 2, true>, bottleneck<512, 1, false>, D>>>;

/// Features, the mean of each channel, and a dense layer.
template <shape Input, class Features, std::size_t Classes>
using resnet = network<Input, Features, named<"avgpool", global_average_pool>, named<"fc", dense<Classes>>>;

/// ResNet-18.
template <shape Input, std::size_t Classes = 1000>
using resnet18 = resnet<Input, resnet_basic_features<2, 2, 2, 2>, Classes>;
/// ResNet-34.
template <shape Input, std::size_t Classes = 1000>
using resnet34 = resnet<Input, resnet_basic_features<3, 4, 6, 3>, Classes>;
/// ResNet-50.
template <shape Input, std::size_t Classes = 1000>
using resnet50 = resnet<Input, resnet_bottleneck_features<3, 4, 6, 3>, Classes>;

}} // namespace tactnet
