#pragma once

#include <tactnet/layers/average_pool.hpp>
#include <tactnet/layers/batch_norm.hpp>
#include <tactnet/layers/composition/concatenation.hpp>
#include <tactnet/layers/composition/fused.hpp>
#include <tactnet/layers/composition/named.hpp>
#include <tactnet/layers/composition/norm_relu_pool.hpp>
#include <tactnet/layers/composition/residual.hpp>
#include <tactnet/layers/composition/sequence.hpp>
#include <tactnet/layers/conv2d.hpp>
#include <tactnet/layers/dense.hpp>
#include <tactnet/layers/dropout.hpp>
#include <tactnet/layers/layer.hpp>
#include <tactnet/layers/local_response_norm.hpp>
#include <tactnet/layers/max_pool.hpp>
#include <tactnet/layers/relu.hpp>
#include <tactnet/layers/softmax.hpp>
