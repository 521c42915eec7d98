#pragma once

#include <tactnet/deployment/lowering/branches.hpp>
#include <tactnet/deployment/lowering/convolution.hpp>
#include <tactnet/deployment/lowering/layers.hpp>
#include <tactnet/deployment/lowering/sequence.hpp>
