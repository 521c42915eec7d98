#pragma once

// The core: shapes, tensors, layers and networks. Training, images and files have umbrellas of their own.

#include <tactnet/layers.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/tensor.hpp>
#include <tactnet/version.hpp>
