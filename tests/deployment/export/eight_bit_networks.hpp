#pragma once

#include "networks.hpp"

#include <tactnet/quantisation.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ratio>
#include <span>
#include <vector>

// Networks that are written as headers in 8 bits. Generator and tests make them alike.

/// Roots of the sensor's counts first, and probabilities as outputs.
using rooted_network =
    tactnet::network<tactnet::shape{8, 9}, tactnet::square_root<std::ratio<3, 8>>, tactnet::conv2d<6, 3>,
                     tactnet::relu, tactnet::max_pool<2>, tactnet::dense<4>, tactnet::softmax>;

/// Roots of bytes between convolutions, and every other kind of step in 8 bits that has a spelling of its
/// own, with a function of a user's own.
using branched_network = tactnet::network<
    tactnet::shape{7, 6, 2}, tactnet::batch_norm, tactnet::conv2d<8, 3>, tactnet::relu,
    tactnet::square_root<>,
    tactnet::residual<tactnet::sequence<tactnet::conv2d<8, 3>, tactnet::relu, tactnet::conv2d<12, 3>>,
                      tactnet::sequence<tactnet::conv2d<12, 1>>>,
    tactnet::relu, tactnet::max_pool<3, 2>,
    tactnet::concatenation<tactnet::sequence<tactnet::conv2d<4, 1>, tactnet::relu>,
                           tactnet::sequence<tactnet::conv2d<8, 3>, tactnet::relu>>,
    tactnet::squeeze_excitation<12, 3, tactnet::hard_sigmoid>,
    tactnet::conv2d<12, 3, 1, tactnet::padding::same, tactnet::in_groups(12)>, tactnet::relu,
    tactnet::conv2d<6, 2, 1, tactnet::padding::same, tactnet::in_groups(2)>, tactnet::batch_norm,
    tactnet::parametric_relu, tactnet::adaptive_max_pool<tactnet::extent2d{5, 4}>,
    tactnet::upsample<tactnet::extent2d{1, 2}>, tactnet::upsample<2, tactnet::interpolation::bilinear>,
    tactnet::transposed_conv2d<5, 3, tactnet::extent2d{2, 1}>, tactnet::dilated_conv2d<7, 3>, tactnet::relu,
    tactnet::conv2d<6, 1>, own::softsign<50>, tactnet::local_response_norm<>, tactnet::group_norm<2>,
    tactnet::relu, tactnet::layer_norm<tactnet::norm_over::channels>,
    tactnet::layer_norm<tactnet::norm_over::frame>, tactnet::average_pool<2, 1>, tactnet::dense<3>,
    tactnet::softmax>;

/// Calibrated on a few frames.
template <class Network>
tactnet::deployed<Network, tactnet::eight_bit> deployed_in_8_bits() {
    const auto net = filled_network<Network>();
    const auto mean = mean_of<Network>();
    std::vector<std::uint8_t> images;
    for (std::size_t i = 0; i < 12; ++i) {
        const auto frame = frame_of<Network>(i);
        images.insert(images.end(), frame.begin(), frame.end());
    }
    return tactnet::deploy<tactnet::eight_bit>(net, mean.view().elements(), 1.0f / 64,
                                               std::span<const std::uint8_t>(images));
}
