#pragma once

#include "softsign.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// The networks that are written as headers. Generator and test make them alike.

using small_network = tactnet::tactnet4<tactnet::shape{7, 13}, 5>;

/// Every kind of step, a function of a user's own that a convolution fuses, and sizes that fill no vector:
/// then distances between pixels depend on the instruction set.
using mixed_network = tactnet::network<
    tactnet::shape{8, 9, 2}, tactnet::batch_norm, tactnet::conv2d<6, 3, tactnet::extent2d(2, 1)>,
    tactnet::relu,
    tactnet::residual<tactnet::sequence<tactnet::conv2d<20, 3>, tactnet::relu, tactnet::conv2d<20, 3>>,
                      tactnet::sequence<tactnet::conv2d<20, 1>, tactnet::batch_norm>>,
    tactnet::relu, tactnet::residual<tactnet::conv2d<20, 3>>, tactnet::max_pool<3, 1>, tactnet::relu,
    tactnet::sequence<tactnet::conv2d<5, 2>, tactnet::max_pool<2>>,
    tactnet::conv2d<10, 3, 1, tactnet::padding::same, tactnet::in_groups(5)>,
    tactnet::conv2d<16, 3, 1, tactnet::padding::same, tactnet::in_groups(1)>,
    tactnet::conv2d<16, 3, 1, tactnet::padding::same, tactnet::in_groups(16)>, tactnet::group_norm<4>,
    tactnet::relu,
    tactnet::named<"mixed", tactnet::concatenation<
                                tactnet::conv2d<8, 1, 1, tactnet::padding::same, tactnet::in_groups(2)>,
                                tactnet::sequence<
                                    tactnet::conv2d<6, 1>, tactnet::relu,
                                    tactnet::conv2d<5, 3, 1, tactnet::padding::same, tactnet::without_bias>>,
                                tactnet::identity_layer>>,
    tactnet::squeeze_excitation<29, 5>, tactnet::instance_norm,
    tactnet::layer_norm<tactnet::norm_over::channels>, tactnet::layer_norm<tactnet::norm_over::frame>,
    tactnet::local_response_norm<>, tactnet::square_root<>, tactnet::leaky_relu<200>,
    tactnet::parametric_relu, tactnet::relu6, tactnet::hard_swish, tactnet::hard_sigmoid, tactnet::silu,
    tactnet::gelu, tactnet::sigmoid, tactnet::hyperbolic_tangent, tactnet::elu<>, tactnet::softplus,
    tactnet::average_pool<2, 1>, tactnet::adaptive_max_pool<tactnet::extent2d{3, 2}>, tactnet::upsample<2>,
    tactnet::upsample_to<tactnet::extent2d{2, 3}, tactnet::interpolation::bilinear>,
    tactnet::transposed_conv2d<2, 3, 2>, tactnet::elu<300>, tactnet::dilated_conv2d<5, 3>, tactnet::gelu,
    tactnet::conv2d<7, 2>, own::softsign<50>, tactnet::dense<3>, tactnet::softmax>;

/// More memory than a stack should hold, a step that is not among those of deployment/, and a function that
/// only a convolution needs.
using large_network =
    tactnet::network<tactnet::shape{6, 5}, tactnet::as_photograph<tactnet::extent2d(300, 310)>,
                     tactnet::conv2d<3, 5, 4, tactnet::padding::valid>, tactnet::leaky_relu<200>,
                     tactnet::max_pool<8>, tactnet::dense<2>>;

/// As a sensor may count: most of it untouched.
template <class Network>
std::array<std::uint8_t, Network::input_shape.size()> frame_of(std::size_t number) {
    std::array<std::uint8_t, Network::input_shape.size()> frame;
    for (std::size_t i = 0; i < frame.size(); ++i) {
        const std::size_t drawn = (i * i * 7 + number * 31 + i * 11) % 97;
        frame[i] = static_cast<std::uint8_t>(drawn < 50 ? 0 : drawn * 2);
    }
    return frame;
}

/// No parameter is left at a value that would hide a mistake.
template <class Network>
Network filled_network() {
    Network net;
    net.for_each_parameter([&](const tactnet::parameter& p, auto values) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            const float drawn = static_cast<float>((i * 73 + i * i * 3 + p.offset * 5) % 201) / 100.0f - 1.0f;
            const bool positive = p.role == tactnet::parameter_role::running_variance ||
                                  p.role == tactnet::parameter_role::scale;
            values[i] = positive ? 1.0f + drawn / 2 : drawn / 4;
        }
    });
    return net;
}
template <class Network>
tactnet::tensor<float, Network::input_shape> mean_of() {
    tactnet::tensor<float, Network::input_shape> mean;
    for (std::size_t i = 0; i < Network::input_shape.size(); ++i)
        mean.data()[i] = static_cast<float>(i % 13) * 1.1f;
    return mean;
}
template <class Network>
tactnet::deployed<Network> deployed_network() {
    const auto mean = mean_of<Network>();
    auto network = tactnet::deploy(filled_network<Network>(), mean.view().elements(), 1.0f / 64);
    network.set_temperature(0.7);
    if constexpr (std::is_same_v<Network, mixed_network>) {
        network.set_input_function({tactnet::count_rule::relative_logarithm, 2});
        network.set_reflections({{}, {true, {2, 1, 0}}});
    }
    return network;
}
