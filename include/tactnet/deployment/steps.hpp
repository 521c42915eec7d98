#pragma once

#include <tactnet/deployment/steps/average_pool.hpp>
#include <tactnet/deployment/steps/chain.hpp>
#include <tactnet/deployment/steps/concatenation.hpp>
#include <tactnet/deployment/steps/convolution.hpp>
#include <tactnet/deployment/steps/dense.hpp>
#include <tactnet/deployment/steps/local_response_norm.hpp>
#include <tactnet/deployment/steps/norm.hpp>
#include <tactnet/deployment/steps/pool.hpp>
#include <tactnet/deployment/steps/relu.hpp>
#include <tactnet/deployment/steps/residual.hpp>
#include <tactnet/deployment/steps/softmax.hpp>
#include <tactnet/deployment/steps/square_root.hpp>
#include <tactnet/deployment/steps/step.hpp>
