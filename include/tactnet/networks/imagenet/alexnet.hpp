#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>

// AlexNet (Krizhevsky, Sutskever, Hinton, "ImageNet classification with deep convolutional neural networks",
// 2012), for images of three channels.

namespace tactnet { inline namespace TACTNET_ARCH {

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

}} // namespace tactnet
