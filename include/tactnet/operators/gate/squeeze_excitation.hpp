#pragma once

#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/activations/piecewise.hpp>
#include <tactnet/operators/activations/smooth.hpp>
#include <tactnet/operators/convolution/layer.hpp>
#include <tactnet/operators/gate/layer.hpp>
#include <tactnet/operators/pooling/layer.hpp>
#include <tactnet/operators/sequence/named.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Squeeze and excitation (Hu, Shen, Sun, "Squeeze-and-excitation networks", 2018): scales each channel by a
/// factor between 0 and 1, which follows from the means of all channels by way of `Squeezed` channels.
/// torchvision's SqueezeExcitation(Channels, Squeezed), with its names `fc1` and `fc2` of convolutions of
/// 1 × 1. `Channels` are those of the input; `Scale` is `sigmoid`, or `hard_sigmoid` as in MobileNetV3
/// (Howard et al., 2019), which also suits 8 bits and small processors.
template <std::size_t Channels, std::size_t Squeezed, class Scale = sigmoid>
using squeeze_excitation = gate<global_average_pool, named<"fc1", conv2d<Squeezed, 1>>, relu,
                                named<"fc2", conv2d<Channels, 1>>, Scale>;

}} // namespace tactnet
