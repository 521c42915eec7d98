#pragma once

#include <tactnet/deployment/steps/branches.hpp>
#include <tactnet/deployment/steps/chain.hpp>
#include <tactnet/deployment/steps/convolution.hpp>
#include <tactnet/deployment/steps/dense.hpp>
#include <tactnet/deployment/steps/elementwise.hpp>
#include <tactnet/deployment/steps/pooling.hpp>
#include <tactnet/deployment/steps/step.hpp>
