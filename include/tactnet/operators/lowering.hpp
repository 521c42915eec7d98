#pragma once

#include <tactnet/operators/activations/lowering.hpp>
#include <tactnet/operators/batch_norm/lowering.hpp>
#include <tactnet/operators/causal_convolution/lowering.hpp>
#include <tactnet/operators/channel_scale/lowering.hpp>
#include <tactnet/operators/concatenation/lowering.hpp>
#include <tactnet/operators/convolution/lowering.hpp>
#include <tactnet/operators/dense/lowering.hpp>
#include <tactnet/operators/dilated_convolution/lowering.hpp>
#include <tactnet/operators/dropout/lowering.hpp>
#include <tactnet/operators/gate/lowering.hpp>
#include <tactnet/operators/last_frame/lowering.hpp>
#include <tactnet/operators/local_response_norm/lowering.hpp>
#include <tactnet/operators/pooling/lowering.hpp>
#include <tactnet/operators/recurrent/lowering.hpp>
#include <tactnet/operators/residual/lowering.hpp>
#include <tactnet/operators/sample_norms/lowering.hpp>
#include <tactnet/operators/sequence/lowering.hpp>
#include <tactnet/operators/transposed_convolution/lowering.hpp>
#include <tactnet/operators/upsampling/lowering.hpp>

// How every operator is lowered to the steps of a deployed network (lowering/lowering.hpp).
