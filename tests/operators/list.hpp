#pragma once

// Every operator of the library, with examples of it: one line tests an operator in everything that holds of
// all. Each folder of include/tactnet/operators/ has an example, which tests/layering/check.py sees to.
//
//     example<"folder", layer, shape of its input, how it is tested (tests, below), its module in PyTorch>
//
// The units of of_all/ each take a slice of the list (CMakeLists.txt), so that none compiles all; with
// TACTNET_FOLDER, those of one folder.

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>
#include <ratio>
#include <string_view>
#include <support/layers/conformance_options.hpp>
#include <tuple>
#include <type_traits>
#include <utility>

namespace support {

/// What an example is tested in, besides what must hold of every layer (support/layers/conformance.hpp).
namespace tests {

/// Deployed: alone, and between a convolution and a dense layer; there in 8 bits and in exported headers,
/// too.
struct all {
    static constexpr conformance_options options{};
    static constexpr bool deployed = true, streamed = false;
    template <class Spec, tactnet::shape Input>
    using network = tactnet::network<Input, tactnet::conv2d<Input.channels, 3>, Spec, tactnet::dense<3>>;
};
/// The same after a convolution, as the last layer.
struct last : all {
    template <class Spec, tactnet::shape Input>
    using network = tactnet::network<Input, tactnet::conv2d<Input.channels, 3>, Spec>;
};
/// The same in front of both.
struct first : all {
    template <class Spec, tactnet::shape Input>
    using network = tactnet::network<Input, Spec, tactnet::conv2d<Input.channels, 3>, tactnet::dense<3>>;
};
/// The same, of counts.
struct first_of_counts : first {
    static constexpr conformance_options options{.low = 1, .high = 255};
};
/// Random in training.
struct random : all {
    static constexpr conformance_options options{.random = true};
};
/// Frame by frame instead, after a causal convolution.
struct stream : all {
    static constexpr bool deployed = false, streamed = true;
    template <class Spec, tactnet::shape Input>
    using network = tactnet::network<Input, tactnet::causal_conv1d<Input.channels, 2>, Spec>;
};
/// In nothing else.
struct batches : all {
    static constexpr bool deployed = false;
};
struct random_batches : batches {
    static constexpr conformance_options options{.random = true};
};
/// Inputs of another range.
template <int Low, int High>
struct inputs : batches {
    static constexpr conformance_options options{.low = Low, .high = High};
};
/// A mean of ten thousand, a deviation of a hundredth: single precision holds such values to 5e-4 only, but
/// what is made of the values that it holds is accurate.
struct far_from_zero : batches {
    static constexpr conformance_options options{.low = 1e4 - 2e-2, .high = 1e4 + 2e-2};
};
/// Epsilon in units of 1e-4.
template <int Parts>
struct epsilon : batches {
    static constexpr conformance_options options{.epsilon = 1e-4 * Parts};
};

} // namespace tests

template <tactnet::name_text Folder, class Spec, tactnet::shape Input, class How = tests::all,
          tactnet::name_text PyTorch = "">
struct example {
    using spec = Spec;
    using how = How;
    static constexpr tactnet::shape input = Input;
    static constexpr std::string_view folder = Folder.view(), pytorch = PyTorch.view();
    using alone = tactnet::network<Input, Spec>;
    using between = typename How::template network<Spec, Input>;
};

namespace list_of_operators {

using namespace tactnet;
using namespace tests;
constexpr interpolation bilinear = interpolation::bilinear;
constexpr norm_over frame = norm_over::frame, channels = norm_over::channels;
constexpr padding same = padding::same, valid = padding::valid;
template <std::size_t Channels>
using depthwise = conv2d<Channels, 3, 1, same, in_groups(Channels)>;

// clang-format off
using all_examples = std::tuple<
    example<"activations", relu, shape{5, 4, 3}, all, "nn.ReLU()">,
    example<"activations", relu, shape{1, 1, 1}, batches>,
    example<"activations", parametric_relu, shape{7, 3, 5}, all, "nn.PReLU(5)">,
    example<"activations", parametric_relu, shape{1, 1, 1}, batches>,
    example<"activations", parametric_relu, shape{7, 6, 2}, inputs<-4, 1>>,
    // In lists, after a layer and before one that write over their inputs.
    example<"activations", sequence<conv2d<4, 3>, relu, parametric_relu, relu, dense<3>>, shape{6, 5, 2}, batches>,
    example<"activations", sequence<conv2d<4, 3>, batch_norm, parametric_relu, max_pool<2>, dense<3>>, shape{6, 5, 2}, batches>,
    example<"activations", softmax, shape{1, 1, 22}, last, "nn.Softmax(1)">,
    example<"activations", softmax, shape{2, 3, 4}, batches, "nn.Softmax(1)">, // over the channels of every pixel
    example<"activations", softmax, shape{1, 1, 1}, batches>,
    example<"activations", square_root<>, shape{2, 3, 5}>, // positive and negative inputs
    example<"activations", square_root<std::ratio<3, 8>>, shape{3, 7, 2}, inputs<1, 255>>, // counts as they are
    example<"activations", square_root<std::ratio<3, 8>>, shape{8, 9, 1}, first_of_counts>,
    example<"activations", elu<>, shape{7, 3, 5}, batches, "nn.ELU()">,
    example<"activations", elu<300>, shape{5, 7, 3}, batches, "nn.ELU(0.3)">,
    example<"activations", silu, shape{5, 7, 3}, batches, "nn.SiLU()">,
    example<"batch_norm", batch_norm, shape{5, 4, 3}>,
    example<"batch_norm", batch_norm, shape{7, 6, 2}, first>,
    example<"batch_norm", batch_norm, shape{7, 13, 2}, batches>, // more values than one run of a sum
    example<"batch_norm", batch_norm, shape{1, 1, 5}, batches>,
    example<"batch_norm", batch_norm, shape{5, 4, 1}, epsilon<1>>, // the paper's epsilon
    example<"batch_norm", batch_norm, shape{5, 4, 3}, far_from_zero>,
    example<"temporal", causal_conv1d<5, 3>, shape{7, 1, 3}, stream>,
    example<"temporal", causal_conv1d<4, 2, 3>, shape{9, 1, 5}, batches>,
    example<"temporal", causal_conv1d<1, 1>, shape{1, 1, 1}, batches>,
    example<"temporal", causal_conv1d<17, 4, 2>, shape{3, 1, 2}, batches>, // taps before the first frame for every output
    example<"temporal", sequence<causal_conv1d<6, 3>, relu, residual<causal_conv1d<6, 3, 2>>, last_frame, dense<3>>, shape{8, 1, 2}, batches>,
    example<"batch_norm", channel_scale, shape{3, 4, 5}>,
    example<"batch_norm", channel_scale, shape{7, 5, 2}, batches>, // more values than one run of a sum
    example<"batch_norm", channel_scale, shape{1, 1, 3}, batches>,
    // At the end of a residual block, as in ConvNeXt.
    example<"batch_norm", residual<sequence<depthwise<3>, layer_norm<channels>, conv2d<6, 1>, gelu, conv2d<3, 1>, channel_scale>>, shape{3, 4, 3},
            batches, "Residual(nn.Conv2d(3, 3, 3, padding=1, groups=3), ChannelsLast(3), nn.Conv2d(3, 6, 1), nn.GELU(), nn.Conv2d(6, 3, 1), LayerScale(3))">,
    example<"concatenation", concatenation<sequence<conv2d<4, 1>, relu>, sequence<conv2d<3, 1>, relu, conv2d<8, 3>>>, shape{4, 3, 5}>,
    // Branches of different depth, with batch norms.
    example<"concatenation", concatenation<sequence<conv2d<3, 1>, batch_norm, relu>, sequence<conv2d<2, 1>, relu, conv2d<4, 3>, batch_norm>>, shape{4, 3, 2}, batches>,
    // The input itself, a pool, a single layer.
    example<"concatenation", concatenation<identity_layer, max_pool<3, 1, pad(1)>, conv2d<2, 1>>, shape{3, 4, 2}, batches>,
    example<"concatenation", sequence<conv2d<3, 1>, concatenation<concatenation<conv2d<2, 1>, relu>, conv2d<1, 3>>, relu, dense<2>>, shape{3, 3, 2}, batches>,
    // Kernels of every kind, odd, even, oblong and wider than what stays in registers; filters and channels that fill
    // register blocks and that do not; images of one tactel, one line and more.
    example<"convolution", conv2d<9, extent2d(3, 2), extent2d(2, 1), pad(1), in_groups(3)>, shape{7, 5, 6}, all, "nn.Conv2d(6, 9, (3, 2), (2, 1), 1, groups=3)">,
    example<"convolution", conv2d<1, 1>, shape{1, 1, 1}, batches>,
    example<"convolution", conv2d<9, 3>, shape{1, 1, 8}, batches>,
    example<"convolution", conv2d<8, 2>, shape{5, 4, 1}, batches>, // pads bottom and right
    example<"convolution", conv2d<9, 3>, shape{7, 13, 3}, batches>,
    example<"convolution", conv2d<16, 4>, shape{5, 4, 3}, batches>,
    example<"convolution", conv2d<8, 5>, shape{7, 13, 1}, batches>,
    example<"convolution", conv2d<22, extent2d{2, 3}>, shape{5, 4, 8}, batches>,
    example<"convolution", conv2d<5, extent2d{5, 1}>, shape{1, 9, 3}, batches>,
    example<"convolution", conv2d<5, 7>, shape{7, 6, 3}, batches>, // over an image no larger
    // Channels that fill vectors of every width: gradients are taken across them.
    example<"convolution", conv2d<13, 3>, shape{4, 3, 16}, batches>,
    example<"convolution", conv2d<2, extent2d{2, 3}, 2>, shape{5, 4, 32}, batches>,
    example<"convolution", conv2d<3, 3, 1, valid>, shape{4, 5, 48}, batches>,
    example<"convolution", conv2d<1, extent2d{1, 2}>, shape{3, 40, 16}, batches>, // rows in several tiles
    example<"convolution", conv2d<22, 3, 1, valid>, shape{7, 13, 3}, batches>,
    example<"convolution", conv2d<5, extent2d{5, 4}, 1, valid>, shape{5, 4, 3}, batches>, // as large as the image
    example<"convolution", conv2d<8, 4, 3, valid>, shape{8, 13, 1}, batches>, // the stride leaves rows unread
    example<"convolution", conv2d<1, 7, 1, valid>, shape{7, 13, 1}, batches>, // wider than the register block
    example<"convolution", conv2d<8, 3, 1, pad(1)>, shape{5, 4, 1}, batches>,
    example<"convolution", conv2d<16, 5, 2, pad(2)>, shape{7, 13, 1}, batches>, // as in TactResNet
    example<"convolution", conv2d<5, 1, 1, pad(1)>, shape{5, 4, 3}, batches>, // windows that see padding alone
    example<"convolution", conv2d<5, 2, 2, pad(2)>, shape{1, 9, 3}, batches>, // more padding than the kernel reaches
    example<"convolution", conv2d<9, 3, 1, pad(0, 1, 2, 0)>, shape{5, 4, 8}, batches>,
    example<"convolution", conv2d<5, extent2d{3, 2}, 2, pad(0, 1, 2, 0)>, shape{5, 4, 3}, batches>,
    example<"convolution", conv2d<16, 3, 1, pad(4)>, shape{3, 4, 16}, batches>, // the same, channels that fill vectors
    example<"convolution", conv2d<6, 3, 1, same, in_groups(2)>, shape{5, 7, 4}, batches>,
    example<"convolution", conv2d<6, 3, 2, pad(1), in_groups(2)>, shape{7, 6, 2 * kernels::lanes<float>}, batches>,
    example<"convolution", conv2d<3, 3, 1, same, conv2d_options{.groups = 3, .bias = false}>, shape{4, 5, 3}, batches>,
    // Wider than a register block, a stride, several filters for each channel.
    example<"convolution", depthwise<3>, shape{4, 13, 3}, batches>,
    example<"convolution", conv2d<3, 5, 2, same, in_groups(3)>, shape{7, 6, 3}, batches>,
    example<"convolution", conv2d<4, 3, 1, same, in_groups(2)>, shape{4, 5, 2}, batches>,
    example<"convolution", conv2d<5, 3, 1, valid, without_bias>, shape{5, 4, 3}, batches>,
    // Strides with 'same' padding: the way back reads the gradient as if zeros stood between its pixels.
    example<"convolution", conv2d<9, 3, 2>, shape{7, 13, 8}, batches>,
    example<"convolution", conv2d<8, 1, 2>, shape{5, 4, 3}, batches>, // a kernel of one leaves pixels unread
    example<"convolution", conv2d<5, 4, 2>, shape{7, 13, 1}, batches>,
    example<"convolution", conv2d<8, 3, 3>, shape{7, 13, 3}, batches>,
    example<"convolution", conv2d<1, extent2d{2, 3}, 3>, shape{7, 13, 1}, batches>,
    example<"convolution", conv2d<16, 3, extent2d{1, 2}>, shape{5, 4, 3}, batches>,
    example<"convolution", conv2d<5, 2, 3>, shape{2, 2, 1}, batches>, // larger than the image
    example<"dense", dense<22>, shape{4, 7, 5}, all, "nn.Sequential(nn.Flatten(), nn.Linear(140, 22))">,
    example<"dense", dense<1>, shape{5, 4, 3}, batches>,
    example<"dense", dense<3>, shape{1, 1, 1}, batches>,
    example<"dense", dense<22>, shape{1, 3, 2}, batches>, // more outputs than inputs
    // 'Same', at sizes that the dilation divides and does not divide.
    example<"dilated_convolution", dilated_conv2d<5, 3>, shape{7, 11, 3}, all, "nn.Conv2d(3, 5, 3, padding='same', dilation=2)">,
    example<"dilated_convolution", dilated_conv2d<5, 3>, shape{6, 8, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<4, 3>, shape{7, 5, 3}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 3>, shape{8, 10, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, extent2d(3, 1), extent2d(2, 4)>, shape{5, 6, 2}, batches>,
    // Even kernels, whose padding is not the same for all phases.
    example<"dilated_convolution", dilated_conv2d<3, 2, 3>, shape{7, 8, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<2, extent2d(2, 4), extent2d(1, 3)>, shape{5, 11, 3}, batches>,
    // Strides that share a factor with the dilation, or none.
    example<"dilated_convolution", dilated_conv2d<7, 3, 2, 2, pad(2)>, shape{9, 5, 2}, batches, "nn.Conv2d(2, 7, 3, 2, 2, dilation=2)">,
    example<"dilated_convolution", dilated_conv2d<3, 3, 2, 2>, shape{9, 7, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 4, 2>, shape{11, 10, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 2, 3>, shape{11, 13, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 2, extent2d(3, 2), extent2d(2, 4), pad(2, 1, 0, 3)>, shape{8, 9, 2}, batches>,
    // Phases that lie side by side where they are deployed.
    example<"dilated_convolution", dilated_conv2d<5, 3, 4>, shape{14, 13, 3}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 5, extent2d(1, 3)>, shape{9, 13, 2}, batches>,
    // Valid, explicit and completed padding; a kernel larger than the map.
    example<"dilated_convolution", dilated_conv2d<3, extent2d(3, 2), extent2d(2, 3), 1, valid>, shape{7, 5, 4}, batches, "nn.Conv2d(4, 3, (3, 2), dilation=(2, 3))">,
    example<"dilated_convolution", dilated_conv2d<4, 3, 2, 1, valid>, shape{7, 9, 3}, batches>,
    example<"dilated_convolution", dilated_conv2d<4, 3, 2, 1, pad(2, 0, 1, 3)>, shape{4, 5, 3}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 2, 2, ceil_mode(pad(1))>, shape{8, 6, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 3>, shape{4, 2, 2}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 5>, shape{1, 1, 2}, batches>,
    // In groups, depthwise, without bias.
    example<"dilated_convolution", dilated_conv2d<5, 3, 3, 1, same, in_groups(5)>, shape{9, 7, 5}, batches, "nn.Conv2d(5, 5, 3, padding='same', dilation=3, groups=5)">,
    example<"dilated_convolution", dilated_conv2d<6, 3, 2, 1, same, in_groups(2)>, shape{5, 7, 4}, batches>,
    example<"dilated_convolution", dilated_conv2d<6, 3, 2, 1, same, in_groups(6)>, shape{6, 5, 6}, batches>,
    example<"dilated_convolution", dilated_conv2d<4, 3, 2, 1, same, without_bias>, shape{5, 5, 3}, batches>,
    example<"dilated_convolution", dilated_conv2d<3, 3, 1, 2, pad(1, 0, 2, 1), in_groups(3)>, shape{8, 9, 6}, batches>, // a dilation of 1
    example<"dilated_convolution", sequence<conv2d<5, 3>, relu, dilated_conv2d<4, 3>, batch_norm, relu, dilated_conv2d<3, 3, 4>, max_pool<2>, dense<3>>, shape{9, 11, 2}, batches>,
    example<"activations", dropout<50>, shape{5, 4, 3}, random>,
    example<"activations", dropout<0>, shape{5, 4, 3}, batches>,
    example<"activations", dropout<90>, shape{1, 1, 7}, random_batches>,
    example<"residual", squeeze_excitation<6, 2>, shape{3, 4, 6}, all, "SqueezeExcitation(6, 2, nn.Sigmoid())">,
    example<"residual", squeeze_excitation<5, 3, hard_sigmoid>, shape{4, 3, 5}, batches, "SqueezeExcitation(5, 3, nn.Hardsigmoid())">,
    example<"residual", gate<global_average_pool>, shape{3, 5, 2}, batches>, // the mean of each channel times the channel itself
    example<"residual", gate<>, shape{1, 1, 4}, batches>, // a map of one pixel by itself, and by a branch with a batch norm
    example<"residual", gate<conv2d<4, 1>, batch_norm, hyperbolic_tangent>, shape{1, 1, 4}, batches>,
    // After a layer that needs its output, before one that writes over its input; and as in MobileNetV3.
    example<"residual", sequence<conv2d<6, 3>, sigmoid, squeeze_excitation<6, 2>, relu, dense<3>>, shape{4, 3, 2}, batches>,
    example<"residual", residual<sequence<conv2d<6, 1>, hard_swish, squeeze_excitation<6, 2, hard_sigmoid>, conv2d<3, 1>, batch_norm>>, shape{3, 4, 3}, batches>,
    example<"residual", sequence<conv2d<12, 3>, hard_swish, squeeze_excitation<12, 5, hard_sigmoid>, conv2d<4, 1>>, shape{9, 11, 3}, batches,
            "nn.Sequential(nn.Conv2d(3, 12, 3, padding=1), nn.Hardswish(), SqueezeExcitation(12, 5, nn.Hardsigmoid()), nn.Conv2d(12, 4, 1))">,
    example<"temporal", last_frame, shape{4, 1, 3}, stream>,
    example<"temporal", last_frame, shape{1, 1, 1}, batches>,
    // Large α, so that the norm does something to numbers around one. AlexNet's exponent, windows cut at both ends.
    example<"sample_norms", local_response_norm<5, std::ratio<2>>, shape{2, 3, 9}, all, "nn.LocalResponseNorm(5, 2)">,
    // An even size, the square root.
    example<"sample_norms", local_response_norm<4, std::ratio<1>, std::ratio<1, 2>, std::ratio<2>>, shape{2, 2, 6}, batches, "nn.LocalResponseNorm(4, 1, 0.5, 2)">,
    // More than there are channels, exponent one.
    example<"sample_norms", local_response_norm<7, std::ratio<1, 2>, std::ratio<1>>, shape{2, 2, 3}, batches>,
    // Any exponent, one channel.
    example<"sample_norms", local_response_norm<1, std::ratio<1>, std::ratio<4, 5>>, shape{2, 2, 4}, batches>,
    example<"sample_norms", local_response_norm<>, shape{2, 3, 7}, inputs<-90, 90>>, // constants as in Caffe
    // Adaptive pools: bins overlap where they must, and repeat where there is too little; side by side, of one pixel and of the image.
    example<"pooling", adaptive_max_pool<extent2d{3, 4}>, shape{7, 11, 2}, all, "nn.AdaptiveMaxPool2d((3, 4))">,
    example<"pooling", adaptive_max_pool<extent2d{9, 2}>, shape{5, 7, 3}, batches, "nn.AdaptiveMaxPool2d((9, 2))">,
    example<"pooling", adaptive_max_pool<extent2d{3, 4}>, shape{5, 9, 2}, batches>,
    example<"pooling", adaptive_max_pool<7>, shape{3, 10, 1}, batches>,
    example<"pooling", adaptive_max_pool<extent2d{2, 3}>, shape{6, 9, 3}, batches>,
    example<"pooling", adaptive_max_pool<extent2d{4, 5}>, shape{4, 5, 2}, batches>,
    example<"pooling", adaptive_max_pool<1>, shape{5, 3, 2}, batches>,
    example<"pooling", sequence<conv2d<5, 3>, relu, adaptive_max_pool<extent2d{3, 2}>, dense<4>>, shape{7, 5, 2}, batches>,
    example<"pooling", adaptive_average_pool<extent2d(3, 4)>, shape{7, 11, 2}, all, "nn.AdaptiveAvgPool2d((3, 4))">,
    example<"pooling", average_pool<2>, shape{5, 7, 3}, all, "nn.AvgPool2d(2, ceil_mode=True)">, // the rest is divided by its own pixels
    example<"pooling", average_pool<3, extent2d{1, 2}, pad(1), average_over::pixels_and_padding>, shape{4, 7, 2}, batches, "nn.AvgPool2d(3, (1, 2), 1)">,
    example<"pooling", average_pool<3, extent2d{1, 2}, pad(1)>, shape{4, 7, 2}, batches, "nn.AvgPool2d(3, (1, 2), 1, count_include_pad=False)">,
    // Ceil mode counts the padding that was given, not what completes a window.
    example<"pooling", average_pool<3, 2, ceil_mode(pad(1)), average_over::pixels_and_padding>, shape{6, 8, 2}, batches, "nn.AvgPool2d(3, 2, 1, ceil_mode=True)">,
    example<"pooling", average_pool<3, 2, ceil_mode()>, shape{6, 7, 1}, batches>,
    example<"pooling", average_pool<extent2d{4, 3}, 1, valid>, shape{4, 3, 2}, batches>,
    example<"pooling", adaptive_average_pool<extent2d{3, 4}>, shape{5, 9, 2}, batches>,
    example<"pooling", adaptive_average_pool<7>, shape{3, 10, 1}, batches>,
    example<"pooling", global_average_pool, shape{5, 6, 3}, batches>,
    example<"pooling", max_pool<2>, shape{7, 13, 2}, all, "nn.MaxPool2d(2, ceil_mode=True)">, // keeps the rest
    example<"pooling", max_pool<2, 1>, shape{5, 4, 3}, batches>,
    example<"pooling", max_pool<2, 2, valid>, shape{7, 13, 2}, batches>, // drops the rest
    example<"pooling", max_pool<3, 2>, shape{7, 12, 1}, batches>,
    example<"pooling", max_pool<3, 2, valid>, shape{7, 12, 2}, batches>,
    example<"pooling", max_pool<3, 1>, shape{5, 4, 1}, batches>,
    example<"pooling", max_pool<5, 1, valid>, shape{5, 9, 2}, batches>,
    example<"pooling", max_pool<5, 1>, shape{4, 3, 1}, batches>,
    example<"pooling", max_pool<extent2d{2, 3}>, shape{7, 13, 1}, batches>,
    example<"pooling", max_pool<extent2d{2, 3}, extent2d{1, 2}, valid>, shape{5, 8, 2}, batches>,
    example<"pooling", max_pool<3, 2, pad(1)>, shape{5, 4, 1}, batches>,
    example<"pooling", max_pool<2>, shape{1, 1, 3}, batches>,
    example<"pooling", max_pool<1, 3>, shape{5, 7, 1}, batches>, // stride larger than the window
    example<"pooling", max_pool<3, 2, ceil_mode()>, shape{6, 7, 2}, batches>, // completes the last window
    example<"pooling", max_pool<3, 5, ceil_mode(pad(1))>, shape{6, 4, 1}, batches>, // windows apart
    example<"pooling", global_max_pool, shape{5, 7, 3}, batches>,
    example<"temporal", gru<5>, shape{7, 1, 3}, stream>,
    example<"temporal", gru<1>, shape{1, 1, 1}, batches>,
    example<"temporal", gru<19>, shape{3, 1, 17}, batches>,
    example<"temporal", sequence<gru<6>, gru<4>, last_frame, dense<3>>, shape{5, 1, 4}, batches>,
    example<"temporal", lstm<5>, shape{7, 1, 3}, stream>,
    example<"temporal", lstm<1>, shape{1, 1, 1}, batches>,
    example<"temporal", lstm<18>, shape{3, 1, 19}, batches>,
    example<"temporal", sequence<lstm<4>, relu, lstm<3>, last_frame>, shape{4, 1, 2}, batches>,
    example<"residual", residual<sequence<conv2d<3, 3>, batch_norm, relu, conv2d<3, 3>, batch_norm>>, shape{4, 3, 3}>,
    // A projection, and a ReLU over the sum; a branch whose last layer needs its output; branches of a single layer.
    example<"residual", sequence<residual<sequence<conv2d<4, 3, 2>, batch_norm>, sequence<conv2d<4, 1, 2>, batch_norm>>, relu>, shape{5, 4, 2}, batches>,
    example<"residual", residual<sequence<conv2d<2, 3>, relu>>, shape{4, 3, 2}, batches>,
    example<"residual", residual<conv2d<3, 3>, conv2d<3, 1>>, shape{4, 3, 2}, batches>,
    example<"rms_norm", rms_norm, shape{5, 4, 7}, all, "nn.Sequential(nn.LocalResponseNorm(15, 15 / 7, 0.5, 1e-5), LayerScale(7))">,
    example<"sample_norms", group_norm<2>, shape{3, 4, 6}, all, "nn.GroupNorm(2, 6)">,
    example<"sample_norms", group_norm<1>, shape{7, 5, 2}, batches, "nn.GroupNorm(1, 2)">, // more values than one run of a sum
    example<"sample_norms", group_norm<2>, shape{1, 1, 6}, batches>,
    example<"sample_norms", group_norm<3>, shape{2, 3, 3}, epsilon<100>>,
    example<"sample_norms", group_norm<2>, shape{3, 4, 4}, far_from_zero>,
    // Between layers that work by parts, before one that writes over its input.
    example<"sample_norms", sequence<conv2d<4, 3>, group_norm<2>, relu, conv2d<6, 2>, group_norm<3>, dense<3>>, shape{4, 3, 2}, batches>,
    example<"sample_norms", instance_norm, shape{4, 3, 5}, all, "nn.InstanceNorm2d(5, affine=True)">,
    example<"sample_norms", layer_norm<frame>, shape{3, 4, 2}, all, "nn.LayerNorm((2, 3, 4))">,
    example<"sample_norms", layer_norm<channels>, shape{3, 4, 7}, all, "ChannelsLast(7)">,
    example<"sample_norms", layer_norm<channels>, shape{1, 1, 3}, batches>,
    example<"sample_norms", layer_norm<frame>, shape{4, 3, 2}, far_from_zero>,
    example<"sample_norms", layer_norm<channels>, shape{2, 2, 6}, far_from_zero>,
    example<"sample_norms", sequence<conv2d<4, 3>, layer_norm<channels>, relu, layer_norm<frame>, dense<3>>, shape{4, 3, 2}, batches>,
    example<"sequence", sequence<conv2d<4, 3>, batch_norm, relu, max_pool<2>>, shape{5, 4, 2}>, // a stage of a network
    example<"sequence", sequence<conv2d<3, 2>, relu>, shape{4, 3, 1}, batches>, // ReLU over the convolution's own output
    example<"sequence", sequence<sequence<conv2d<3, 3>, relu>, sequence<max_pool<2>, dense<4>>, softmax>, shape{4, 5, 1}, batches>,
    example<"sequence", sequence<>, shape{4, 3, 2}, batches>,
    // Kernels of the stride's size, side by side.
    example<"dilated_convolution", transposed_conv2d<5, 2>, shape{3, 4, 2}, batches>,
    example<"dilated_convolution", transposed_conv2d<3, extent2d{1, 3}>, shape{4, 2, 5}, batches>,
    // Kernels that overlap, cropped as PyTorch does, and kernels that leave gaps.
    example<"dilated_convolution", transposed_conv2d<7, 3, 2, pad(1, 0, 1, 0)>, shape{5, 3, 4}, all, "nn.ConvTranspose2d(4, 7, 3, 2, 1, output_padding=1)">,
    example<"dilated_convolution", transposed_conv2d<5, extent2d(3, 4), extent2d(2, 3), valid>, shape{5, 7, 3}, batches, "nn.ConvTranspose2d(3, 5, (3, 4), (2, 3))">,
    example<"dilated_convolution", transposed_conv2d<3, 2, 3, valid, false>, shape{3, 5, 2}, batches, "nn.ConvTranspose2d(2, 3, 2, 3, bias=False)">,
    example<"dilated_convolution", transposed_conv2d<5, 1>, shape{1, 1, 3}, batches, "nn.ConvTranspose2d(3, 5, 1)">,
    example<"dilated_convolution", transposed_conv2d<4, 3, 2, pad(1, 0, 1, 0)>, shape{3, 5, 3}, batches>,
    example<"dilated_convolution", transposed_conv2d<3, extent2d{4, 5}, 2, pad(1, 2, 3, 0)>, shape{4, 3, 2}, batches>,
    example<"dilated_convolution", transposed_conv2d<2, 3, 2, valid>, shape{3, 4, 9}, batches>,
    example<"dilated_convolution", transposed_conv2d<3, 2, extent2d{3, 4}>, shape{3, 2, 2}, batches>,
    // 'Same' with kernels larger than the stride.
    example<"dilated_convolution", transposed_conv2d<8, 4, 2>, shape{3, 3, 8}, batches>,
    example<"dilated_convolution", transposed_conv2d<3, 5, extent2d{3, 2}>, shape{2, 5, 2}, batches>,
    // Stride 1, without bias, one pixel.
    example<"dilated_convolution", transposed_conv2d<6, 3, 1, same, false>, shape{5, 6, 4}, batches>,
    example<"dilated_convolution", transposed_conv2d<3, 2, 1, valid>, shape{4, 5, 2}, batches>,
    example<"dilated_convolution", transposed_conv2d<4, 3, 2, same, false>, shape{1, 1, 3}, batches>,
    example<"dilated_convolution", sequence<conv2d<5, 3, 2>, relu, transposed_conv2d<4, 4, 2>, batch_norm, relu>, shape{6, 4, 2}, batches>,
    // By one factor and by another for rows and columns.
    example<"pooling", upsample<3>, shape{5, 7, 2}, all, "nn.Upsample(scale_factor=3, mode='nearest')">,
    example<"pooling", upsample<2>, shape{3, 5, 3}, batches>,
    example<"pooling", upsample<extent2d{1, 3}>, shape{4, 3, 2}, batches>,
    example<"pooling", upsample<extent2d(2, 3), bilinear>, shape{5, 7, 2}, all, "nn.Upsample(scale_factor=(2, 3), mode='bilinear')">,
    example<"pooling", upsample<2, bilinear>, shape{3, 5, 3}, batches>,
    example<"pooling", upsample<extent2d{3, 1}, bilinear>, shape{4, 3, 2}, batches>,
    example<"pooling", upsample<4, bilinear>, shape{1, 2, 1}, batches>,
    // Larger, smaller, and the size that the map has.
    example<"pooling", upsample_to<extent2d(13, 5)>, shape{5, 7, 3}, batches, "nn.Upsample((13, 5), mode='nearest')">,
    example<"pooling", upsample_to<extent2d(11, 17), bilinear>, shape{7, 13, 3}, batches, "nn.Upsample((11, 17), mode='bilinear')">,
    example<"pooling", upsample_to<extent2d(3, 5), bilinear>, shape{7, 13, 2}, batches, "nn.Upsample((3, 5), mode='bilinear')">,
    example<"pooling", upsample_to<extent2d{7, 13}>, shape{4, 5, 2}, batches>,
    example<"pooling", upsample_to<extent2d{7, 13}, bilinear>, shape{4, 5, 2}, batches>,
    example<"pooling", upsample_to<extent2d{3, 4}>, shape{7, 9, 1}, batches>,
    example<"pooling", upsample_to<extent2d{3, 4}, bilinear>, shape{7, 9, 1}, batches>,
    example<"pooling", upsample_to<extent2d{4, 6}, bilinear>, shape{4, 6, 2}, batches>,
    example<"pooling", sequence<conv2d<5, 3>, relu, upsample<2, bilinear>, relu, conv2d<3, 3>>, shape{4, 3, 2}, batches>
>;
// clang-format on

} // namespace list_of_operators

namespace detail {

template <template <class> class Wanted, std::size_t Slice, std::size_t Count, std::size_t Number,
          class Found, class Rest>
struct slice_of;
template <template <class> class Wanted, std::size_t Slice, std::size_t Count, std::size_t Number,
          class Found>
struct slice_of<Wanted, Slice, Count, Number, Found, std::tuple<>> {
    using type = Found;
};
template <template <class> class Wanted, std::size_t Slice, std::size_t Count, std::size_t Number,
          class... Found, class First, class... Rest>
struct slice_of<Wanted, Slice, Count, Number, std::tuple<Found...>, std::tuple<First, Rest...>>
    : slice_of<Wanted, Slice, Count, Number + Wanted<First>::value,
               std::conditional_t<Wanted<First>::value && Number % Count == Slice,
                                  std::tuple<Found..., First>, std::tuple<Found...>>,
               std::tuple<Rest...>> {};

} // namespace detail

/// Every `Count`th example from number `Slice`, of those for which `Wanted<Example>` holds.
template <template <class> class Wanted, std::size_t Slice, std::size_t Count>
using examples_of_slice =
    typename detail::slice_of<Wanted, Slice, Count, 0, std::tuple<>, list_of_operators::all_examples>::type;

#ifdef TACTNET_FOLDER
constexpr std::string_view wanted_folder = TACTNET_FOLDER;
#else
constexpr std::string_view wanted_folder;
#endif
template <class Example>
struct any_example : std::bool_constant<wanted_folder.empty() || wanted_folder == Example::folder> {};
template <class Example>
struct deployed_example : std::bool_constant<any_example<Example>::value && Example::how::deployed> {};
template <class Example>
struct pytorch_example : std::bool_constant<!Example::pytorch.empty()> {};
template <class Example>
struct streamed_example : std::bool_constant<any_example<Example>::value && Example::how::streamed> {};

} // namespace support
