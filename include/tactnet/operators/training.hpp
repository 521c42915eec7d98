#pragma once

#include <tactnet/operators/activations/training.hpp>
#include <tactnet/operators/batch_norm/training.hpp>
#include <tactnet/operators/causal_convolution/training.hpp>
#include <tactnet/operators/channel_scale/training.hpp>
#include <tactnet/operators/concatenation/training.hpp>
#include <tactnet/operators/convolution/training.hpp>
#include <tactnet/operators/dense/training.hpp>
#include <tactnet/operators/dilated_convolution/training.hpp>
#include <tactnet/operators/dropout/training.hpp>
#include <tactnet/operators/gate/training.hpp>
#include <tactnet/operators/last_frame/training.hpp>
#include <tactnet/operators/local_response_norm/training.hpp>
#include <tactnet/operators/norm_relu_pool/training.hpp>
#include <tactnet/operators/pooling/training.hpp>
#include <tactnet/operators/recurrent/training.hpp>
#include <tactnet/operators/residual/training.hpp>
#include <tactnet/operators/sample_norms/training.hpp>
#include <tactnet/operators/sequence/training.hpp>
#include <tactnet/operators/transposed_convolution/training.hpp>
#include <tactnet/operators/upsampling/training.hpp>

// How every operator computes batches, in training and in inference (trained_layer.hpp).
