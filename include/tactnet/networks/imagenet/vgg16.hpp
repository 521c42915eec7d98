#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>

// VGG16 (Simonyan, Zisserman, "Very deep convolutional networks for large-scale image recognition", 2015,
// configuration D), for images of three channels, by convention 224 × 224. Arrays have torchvision's names.

namespace tactnet { inline namespace TACTNET_ARCH {

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

}} // namespace tactnet
