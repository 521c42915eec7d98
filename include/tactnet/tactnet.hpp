#pragma once

#include <tactnet/deployment.hpp>
#include <tactnet/detail/instruction_set.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/tensor/batch.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/version.hpp>

// The core: shapes, tensors, layers, networks and their deployed form. Training, images and files have
// umbrellas of their own.
