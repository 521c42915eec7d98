#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>
#include <type_traits>
#include <utility>

// SqueezeNet (Iandola et al., "SqueezeNet: AlexNet-level accuracy with 50x fewer parameters", 2016), for
// images of three channels, by convention 227 × 227 or 224 × 224, and any other size whose maps hold the
// windows of the pools. Arrays have torchvision's names.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A fire module: 1 × 1 convolutions squeeze the channels, 1 × 1 and 3 × 3 ones expand them, side by side.
template <std::size_t Squeeze, std::size_t Expand>
using squeezenet_fire =
    sequence<named<"squeeze", conv2d<Squeeze, 1>>, relu,
             named<"", concatenation<unnamed<named<"expand1x1", conv2d<Expand, 1>>, relu>,
                                     unnamed<named<"expand3x3", conv2d<Expand, 3>>, relu>>>>;

/// The features of version 1.1, 512 channels. It costs 2.4 times less than 1.0 at the same accuracy.
using squeezenet1_1_features =
    named<"features",
          sequential<conv2d<64, 3, 2, padding::valid>, relu, max_pool<3, 2, ceil_mode()>,             //
                     squeezenet_fire<16, 64>, squeezenet_fire<16, 64>, max_pool<3, 2, ceil_mode()>,   //
                     squeezenet_fire<32, 128>, squeezenet_fire<32, 128>, max_pool<3, 2, ceil_mode()>, //
                     squeezenet_fire<48, 192>, squeezenet_fire<48, 192>, squeezenet_fire<64, 256>,
                     squeezenet_fire<64, 256>>>;

/// The features of version 1.0, of the paper.
using squeezenet1_0_features =
    named<"features",
          sequential<conv2d<96, 7, 2, padding::valid>, relu, max_pool<3, 2, ceil_mode()>,        //
                     squeezenet_fire<16, 64>, squeezenet_fire<16, 64>, squeezenet_fire<32, 128>, //
                     max_pool<3, 2, ceil_mode()>,                                                //
                     squeezenet_fire<32, 128>, squeezenet_fire<48, 192>, squeezenet_fire<48, 192>,
                     squeezenet_fire<64, 256>, //
                     max_pool<3, 2, ceil_mode()>, squeezenet_fire<64, 256>>>;

/// The last convolution has a filter for each class; its maps are averaged. The authors and torchvision have
/// the ReLU before the mean.
template <std::size_t Classes>
using squeezenet_classifier =
    named<"classifier", sequential<dropout<50>, conv2d<Classes, 1>, relu, global_average_pool>>;

/// The features alone, for layers that are trained on top of them.
template <shape Input>
using squeezenet1_1_trunk = network<Input, squeezenet1_1_features>;
/// The layers of SqueezeNet 1.0 before its classifier.
template <shape Input>
using squeezenet1_0_trunk = network<Input, squeezenet1_0_features>;

/// SqueezeNet 1.1.
template <shape Input, std::size_t Classes = 1000>
using squeezenet1_1 = network<Input, squeezenet1_1_features, squeezenet_classifier<Classes>>;
/// SqueezeNet 1.0.
template <shape Input, std::size_t Classes = 1000>
using squeezenet1_0 = network<Input, squeezenet1_0_features, squeezenet_classifier<Classes>>;

// AlexNet (Krizhevsky, Sutskever, Hinton, "ImageNet classification with deep convolutional neural networks",
// 2012), for images of three channels.

/// The convolutions of the original: the second, the fourth and the fifth in two groups, and local response
/// normalisation between the first two and their pools, with the constants of Caffe and MATLAB (k = 1; the
/// paper's text has 2) and their names.
using alexnet_original_features =
    unnamed<named<"conv1", conv2d<96, 11, 4, padding::valid>>, relu, local_response_norm<>,
            max_pool<3, 2, padding::valid>,                                                       //
            named<"conv2", conv2d<256, 5, 1, pad(2), in_groups(2)>>, relu, local_response_norm<>, //
            max_pool<3, 2, padding::valid>,                                                       //
            named<"conv3", conv2d<384, 3, 1, pad(1)>>, relu,                                      //
            named<"conv4", conv2d<384, 3, 1, pad(1), in_groups(2)>>, relu,                        //
            named<"conv5", conv2d<256, 3, 1, pad(1), in_groups(2)>>, relu, max_pool<3, 2, padding::valid>>;

/// The original, by convention at 227 × 227: 60 965 224 parameters there. `Hidden` is the width of the two
/// dense layers before the last.
template <shape Input, std::size_t Classes = 1000, std::size_t Hidden = 4096>
using alexnet_original = network<Input, alexnet_original_features,               //
                                 named<"fc6", dense<Hidden>>, relu, dropout<50>, //
                                 named<"fc7", dense<Hidden>>, relu, dropout<50>, //
                                 named<"fc8", dense<Classes>>>;

/// torchvision's variant ("One weird trick for parallelizing convolutional neural networks", Krizhevsky,
/// 2014): one column, without normalisation, and its names.
using alexnet_features =
    named<"features", sequential<conv2d<64, 11, 4, pad(2)>, relu, max_pool<3, 2, padding::valid>, //
                                 conv2d<192, 5, 1, pad(2)>, relu, max_pool<3, 2, padding::valid>, //
                                 conv2d<384, 3, 1, pad(1)>, relu,                                 //
                                 conv2d<256, 3, 1, pad(1)>, relu,                                 //
                                 conv2d<256, 3, 1, pad(1)>, relu, max_pool<3, 2, padding::valid>>>;

/// By convention at 224 × 224; 61 100 840 parameters at any size, since the maps are averaged to 6 × 6.
template <shape Input, std::size_t Classes = 1000, std::size_t Hidden = 4096>
using alexnet = network<Input, alexnet_features, named<"avgpool", adaptive_average_pool<6>>,
                        named<"classifier", sequential<dropout<50>, dense<Hidden>, relu, dropout<50>,
                                                       dense<Hidden>, relu, dense<Classes>>>>;

/// Its features, for layers that are trained on top of them: the values of the second dense layer before its
/// ReLU, known as fc7.
template <shape Input, std::size_t Hidden = 4096>
using alexnet_fc7 =
    network<Input, alexnet_features, named<"avgpool", adaptive_average_pool<6>>,
            named<"classifier", sequential<dropout<50>, dense<Hidden>, relu, dropout<50>, dense<Hidden>>>>;

// VGG16 (Simonyan, Zisserman, "Very deep convolutional networks for large-scale image recognition", 2015,
// configuration D), for images of three channels, by convention 224 × 224. Arrays have torchvision's names.

/// A convolution of VGG16.
template <std::size_t Filters>
using vgg_convolution = conv2d<Filters, 3, 1, pad(1)>;
/// A pool of VGG16.
using vgg_pool = max_pool<2, 2, padding::valid>;

/// The convolutions: 512 channels.
using vgg16_features =
    named<"features",
          sequential<
              vgg_convolution<64>, relu, vgg_convolution<64>, relu, vgg_pool,                               //
              vgg_convolution<128>, relu, vgg_convolution<128>, relu, vgg_pool,                             //
              vgg_convolution<256>, relu, vgg_convolution<256>, relu, vgg_convolution<256>, relu, vgg_pool, //
              vgg_convolution<512>, relu, vgg_convolution<512>, relu, vgg_convolution<512>, relu, vgg_pool, //
              vgg_convolution<512>, relu, vgg_convolution<512>, relu, vgg_convolution<512>, relu, vgg_pool>>;

/// 138 357 544 parameters at any size, since the maps are averaged to 7 × 7, their size at 224 × 224.
/// `Hidden` is the width of the two dense layers before the last.
template <shape Input, std::size_t Classes = 1000, std::size_t Hidden = 4096>
using vgg16 = network<Input, vgg16_features, named<"avgpool", adaptive_average_pool<7>>,
                      named<"classifier", sequential<dense<Hidden>, relu, dropout<50>, dense<Hidden>, relu,
                                                     dropout<50>, dense<Classes>>>>;

/// Its features, for layers that are trained on top of them: the values of the first dense layer before its
/// ReLU, known as fc6.
template <shape Input, std::size_t Hidden = 4096>
using vgg16_fc6 = network<Input, vgg16_features, named<"avgpool", adaptive_average_pool<7>>,
                          named<"classifier", sequential<dense<Hidden>>>>;

// Residual networks (He, Zhang, Ren, Sun, "Deep residual learning for image recognition", 2016, table 1), for
// images of three channels, by convention 224 × 224. As in torchvision, the 3 × 3 convolution of a bottleneck
// has its stride (version 1.5), and arrays have torchvision's names.

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
