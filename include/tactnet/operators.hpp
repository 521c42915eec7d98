#pragma once

#include <tactnet/operators/activations/piecewise.hpp>
#include <tactnet/operators/activations/smooth.hpp>
#include <tactnet/operators/folders.hpp>
#include <tactnet/operators/sequence/layer.hpp>

// Every operator, as layers to build networks of.
