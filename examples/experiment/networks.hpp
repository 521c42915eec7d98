#pragma once

// A compile-time experiment: your own networks at your own sizes, which tactnet_experiment trains,
// times and compares as `tactnet` does the paper's. Copy this folder, and change networks and sizes; each is
// compiled by itself.
//
//     tactnet_experiment simulate --out touches --per-class 20
//     tactnet_experiment study --data touches --results experiment

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <cstddef>

namespace experiment {

using namespace tactnet;

/// Pools halve the maps.
template <shape Input, std::size_t Classes>
using small_pooling = network<Input,                                        //
                              conv2d<8, 3>, batch_norm, relu, max_pool<2>,  //
                              conv2d<16, 3>, batch_norm, relu, max_pool<2>, //
                              dense<Classes>>;

/// Convolutions of stride 2 halve them.
template <shape Input, std::size_t Classes>
using small_striding = network<Input,                              //
                               conv2d<8, 3, 2>, batch_norm, relu,  //
                               conv2d<16, 3, 2>, batch_norm, relu, //
                               dense<Classes>>;

} // namespace experiment
