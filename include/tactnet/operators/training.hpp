#pragma once

#include <tactnet/operators/norm_relu_pool/training.hpp>

// clang-format off
#define TACTNET_FILE_OF(folder) <tactnet/operators/folder/training.hpp>
// clang-format on
#include <tactnet/operators/folders.hpp>

// How every operator computes batches, in training and in inference (trained_layer.hpp).
