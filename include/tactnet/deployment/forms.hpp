#pragma once

#include <tactnet/deployment/forms/average_pool.hpp>
#include <tactnet/deployment/forms/concatenation.hpp>
#include <tactnet/deployment/forms/convolution.hpp>
#include <tactnet/deployment/forms/dense.hpp>
#include <tactnet/deployment/forms/dropout.hpp>
#include <tactnet/deployment/forms/local_response_norm.hpp>
#include <tactnet/deployment/forms/named.hpp>
#include <tactnet/deployment/forms/norm.hpp>
#include <tactnet/deployment/forms/pool.hpp>
#include <tactnet/deployment/forms/relu.hpp>
#include <tactnet/deployment/forms/residual.hpp>
#include <tactnet/deployment/forms/sequence.hpp>
#include <tactnet/deployment/forms/softmax.hpp>
#include <tactnet/deployment/forms/square_root.hpp>
