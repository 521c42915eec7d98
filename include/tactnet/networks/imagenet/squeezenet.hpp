#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>

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

}} // namespace tactnet
