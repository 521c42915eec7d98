#pragma once

#include <tactnet/deployment/lowering/average_pool.hpp>
#include <tactnet/deployment/lowering/concatenation.hpp>
#include <tactnet/deployment/lowering/convolution.hpp>
#include <tactnet/deployment/lowering/dense.hpp>
#include <tactnet/deployment/lowering/dropout.hpp>
#include <tactnet/deployment/lowering/list.hpp>
#include <tactnet/deployment/lowering/local_response_norm.hpp>
#include <tactnet/deployment/lowering/named.hpp>
#include <tactnet/deployment/lowering/norm.hpp>
#include <tactnet/deployment/lowering/pool.hpp>
#include <tactnet/deployment/lowering/relu.hpp>
#include <tactnet/deployment/lowering/residual.hpp>
#include <tactnet/deployment/lowering/softmax.hpp>
#include <tactnet/deployment/lowering/square_root.hpp>
