#pragma once

#include <tactnet/operators/activations/eight_bit.hpp>
#include <tactnet/operators/batch_norm/eight_bit.hpp>
#include <tactnet/operators/causal_convolution/eight_bit.hpp>
#include <tactnet/operators/convolution/eight_bit.hpp>
#include <tactnet/operators/dense/eight_bit.hpp>
#include <tactnet/operators/dilated_convolution/eight_bit.hpp>
#include <tactnet/operators/gate/eight_bit.hpp>
#include <tactnet/operators/local_response_norm/eight_bit.hpp>
#include <tactnet/operators/pooling/eight_bit.hpp>
#include <tactnet/operators/recurrent/eight_bit.hpp>
#include <tactnet/operators/residual/eight_bit.hpp>
#include <tactnet/operators/sample_norms/eight_bit.hpp>
#include <tactnet/operators/sequence/eight_bit.hpp>
#include <tactnet/operators/upsampling/eight_bit.hpp>

// The 8-bit steps of every operator that has one.
